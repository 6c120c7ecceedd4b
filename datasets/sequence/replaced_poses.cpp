#include "datasets/sequence/replaced_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mosbench/pose_refiner.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

class StandingSequence : public PosedSequence {
 public:
  StandingSequence(std::unique_ptr<Sequence> inner, const std::string& remark, double passed_over_m)
      : PosedSequence(std::move(inner), {.source = std::string(kStaticPoses)}, Deskew::kNone) {
    constexpr double kStill_m = 0.05;
    set_poses(std::vector<Pose>(size(), Pose::Identity()), remark);
    if (passed_over_m <= kStill_m) return;
    mutable_recording().doubts.push_back(
        fmt::format("the poses of the data set move by {:.2f} m and are not used ({})",
                    passed_over_m, option("poses", std::string(kStaticPoses))));
  }
};

/// How far a list of poses is off another, and where most.
struct Moves {
  double median_m = 0.0, median_deg = 0.0, most_m = 0.0;
  std::size_t most_scan = 0;
};

Moves moves_between(const std::vector<Pose>& given, const std::vector<Pose>& refined) {
  constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;
  Moves moves;
  std::vector<double> all_m, all_deg;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const Pose change = given[k].inverse() * refined[k];
    all_m.push_back(change.translation().norm());
    all_deg.push_back(kDegPerRad * Eigen::AngleAxisd(change.linear()).angle());
    if (all_m[k] <= moves.most_m) continue;
    moves.most_m = all_m[k];
    moves.most_scan = k;
  }
  moves.median_m = quantile(std::move(all_m), 0.5, QuantileRule::kUpper);
  moves.median_deg = quantile(std::move(all_deg), 0.5, QuantileRule::kUpper);
  return moves;
}

std::string remark_on(const Sequence& sequence, const std::vector<Pose>& given,
                      const RefinedPoses& refined) {
  const std::size_t motions = given.size() - 1, failed = refined.failed.size();
  const auto fits = [&](const char* word) {
    return fmt::format("neighbouring scans fit within {:.1f} cm{}{:.1f} cm",
                       100.0 * refined.given_fit_m, word, 100.0 * refined.fit_m);
  };
  std::string remark;
  if (refined.corrected == 0) {
    remark = fmt::format("poses kept as given: registration of the scans is hardly better, {}",
                         fits(" as given, as registered "));
  } else {
    const Moves moves = moves_between(given, refined.map_from_sensor);
    remark = fmt::format(
        "poses refined: moved by {:.1f} cm and {:.2f} degrees in the median, at most {:.1f} cm at "
        "scan {}; {}",
        100.0 * moves.median_m, moves.median_deg, 100.0 * moves.most_m,
        sequence.stem(moves.most_scan), fits(" as given, now "));
    if (refined.corrected < motions) {
      remark +=
          fmt::format("; {} of {} kept, as registration is hardly better",
                      motions - refined.corrected, counted(motions, "motion is", "motions are"));
    }
  }
  if (failed == 0) return remark;
  return remark + fmt::format("; {} could not be registered, first {}: moved as given",
                              counted(failed, "scan"), sequence.stem(refined.failed.front()));
}

RefinedPoses refined_poses(const Sequence& sequence, const ScanCount& count) {
  PoseRefiner refiner;
  Frame frame;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    sequence.read(k, frame);
    refiner.push(frame.points, frame.map_from_sensor);
    if (count) count(sequence.name(), k + 1, sequence.size());
  }
  return refiner.finish();
}

/// The same for equal files that are read equally: a run opens its data once per method.
RefinedPoses known_refined_poses(const Sequence& sequence, const ScanCount& count) {
  static std::mutex mutex;
  static std::map<std::string, RefinedPoses> known;
  std::string key = sequence.name() + file_stamp(sequence);
  for (const auto& [what, how] : members_of(sequence.reading())) {
    key += fmt::format("\n{}: {}", what, how);
  }
  const std::lock_guard lock(mutex);
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  return known[key] = refined_poses(sequence, count);
}

}  // namespace

std::unique_ptr<Sequence> with_static_poses(std::unique_ptr<Sequence> inner,
                                            const std::string& remark, double passed_over_m) {
  return std::make_unique<StandingSequence>(std::move(inner), remark, passed_over_m);
}

std::unique_ptr<Sequence> with_refined_poses(std::unique_ptr<Sequence> inner,
                                             std::optional<Deskew> deskew, const ScanCount& count) {
  const std::vector<Pose> given = poses_of(*inner);
  PosesDone how = inner->reading().poses;
  how.refined = true;
  auto posed = std::make_unique<PosedSequence>(std::move(inner), std::move(how),
                                               deskew.value_or(Deskew::kNone), deskew.has_value());
  posed->set_poses(given);
  const RefinedPoses refined = known_refined_poses(*posed, count);
  posed->set_poses(refined.map_from_sensor, remark_on(*posed, given, refined));
  return posed;
}

}  // namespace mosbench
