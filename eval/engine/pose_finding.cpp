#include "eval/engine/pose_finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// "poses found by SiMpLE", and how many of them are doubtful with the first; loudly where most
/// are.
std::string odometry_remark(const Sequence& sequence, const OdometryChoice& choice,
                            const std::vector<ScanPose>& scans) {
  std::string remark = fmt::format("poses found by {}", choice.kind->title);
  const auto first = std::ranges::find_if(scans, &ScanPose::doubtful);
  if (first == scans.end()) return remark;
  const auto k = static_cast<std::size_t>(first - scans.begin());
  const auto doubtful = static_cast<std::size_t>(std::ranges::count_if(scans, &ScanPose::doubtful));
  const char* loud = 2 * doubtful > scans.size()
                         ? "MOST POSES ARE DOUBTFUL, and labels made with them are, too: "
                         : "";
  return loud + remark +
         fmt::format("; {} of {} are doubtful, first that of scan {}: {}", doubtful, scans.size(),
                     sequence.stem(k), first->doubt);
}

/// Which points of a scan move, as seen from the pose that was just found.
std::vector<std::uint8_t> moving_points(Method& method, const MovingFilter& filter,
                                        const Sequence& sequence, std::size_t k,
                                        const Frame& frame) {
  const std::vector<LabelledScan> labelled = push_scan(method, sequence, k, frame);
  if (labelled.empty() || labelled.back().scan_index != k) {
    throw UsageError(fmt::format("drop_moving: {} labels scans later, expected an online method",
                                 filter.method->name));
  }
  std::vector<std::uint8_t> moving;
  for (const std::uint32_t label : labelled.back().labels) moving.push_back(label == kMovingLabel);
  return moving;
}

nlohmann::ordered_json rows_json(const auto& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto row : matrix.rowwise()) {
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

}  // namespace

OdometryChoice with_filter(OdometryChoice choice, DatasetKind kind) {
  const MethodKind& method = default_method();
  if (choice.drop_moving) {
    choice.filter = moving_filter(method, settings_of(default_preset(kind), method));
  }
  return choice;
}

void expect_poses(Dataset& dataset, const OdometryChoice& choice) {
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = std::make_unique<PosedSequence>(std::move(sequence), statement_of(choice),
                                               choice.deskew, choice.says_deskew);
  }
}

std::vector<ScanPose> estimate_poses(const Sequence& sequence, const OdometryChoice& choice,
                                     unsigned threads, std::size_t most_scans) {
  const std::size_t scans = std::min(sequence.size(), most_scans);
  Progress progress(fmt::format("{} of {}", choice.kind->title, sequence.name()), scans);
  const std::unique_ptr<Odometry> odometry = choice.kind->make(choice.settings, threads);
  const auto& filter = choice.filter;
  const RunContext context{.threads = threads, .scan_count = sequence.size()};
  const auto method = filter ? filter->method->make(filter->settings, context) : nullptr;
  std::vector<ScanPose> poses;
  Frame frame;
  for (std::size_t k = 0; k < scans; ++k) {
    sequence.read(k, frame);
    poses.push_back(odometry->push(frame.points, {frame.stamp_ns, frame.point_times_ns}));
    if (method) {
      frame.map_from_sensor = poses.back().map_from_sensor;
      odometry->leave_out(moving_points(*method, *filter, sequence, k, frame));
    }
    progress.advance();
  }
  return poses;
}

std::vector<ScanPose> find_poses(const Sequence& sequence, const OdometryChoice& choice,
                                 unsigned threads) {
  const auto& posed = dynamic_cast<const PosedSequence&>(sequence);
  std::vector<ScanPose> scans = estimate_poses(posed.unposed(), choice, threads);
  tell(fmt::format("{}: {}", sequence.name(), odometry_remark(sequence, choice, scans)));
  return scans;
}

void set_poses(Sequence& sequence, const OdometryChoice& choice,
               const std::vector<ScanPose>& scans) {
  auto& posed = dynamic_cast<PosedSequence&>(sequence);
  posed.set_poses(poses_of(scans), odometry_remark(sequence, choice, scans));
  std::string doubt = doubt_about(doubtful_poses(sequence, scans), scans.size());
  if (!doubt.empty()) posed.add_doubt(std::move(doubt));
}

std::vector<DoubtfulPose> doubtful_poses(const Sequence& sequence,
                                         const std::vector<ScanPose>& scans) {
  std::vector<DoubtfulPose> doubtful;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (scans[k].doubtful()) doubtful.push_back({sequence.stem(k), scans[k].doubt});
  }
  return doubtful;
}

PoseMark mark_of_poses(const Sequence& sequence) {
  return {mark_as_read(sequence).simulated, doubts_that_stay(doubts_of(sequence), sequence)};
}

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans) {
  std::vector<Pose> poses;
  for (const ScanPose& scan : scans) poses.push_back(scan.map_from_sensor);
  return poses;
}

void SharedReading::share(Dataset& dataset) {
  const std::size_t most_bytes = std::min(memory_bytes() / 4, std::size_t{2} << 30);
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    std::shared_ptr<KeptScans>& scans = scans_[i];
    if (!scans) scans = std::make_shared<KeptScans>(most_bytes);
    dataset.sequences[i] = std::make_unique<KeptSequence>(std::move(dataset.sequences[i]), scans);
  }
}

std::vector<ScanPose> SharedReading::poses_of(std::size_t position, const Sequence& sequence,
                                              const OdometryChoice& choice, unsigned threads) {
  if (choice.filter) return find_poses(sequence, choice, threads);
  const auto known = poses_.find(position);
  if (known != poses_.end()) return known->second;
  return poses_[position] = find_poses(sequence, choice, threads);
}

void SharedReading::forget(std::size_t position) {
  scans_.at(position)->clear();
  poses_.erase(position);
}

void check_stamps_of_tum(const Sequence& sequence) {
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const auto stamp_ns = sequence.stamp_ns(k);
    if (!stamp_ns) {
      throw UsageError(fmt::format(
          "TUM rows (a file called *.tum, or tum:FILE) have stamps, but the scans of {} have "
          "none, expected kitti:FILE or a file called *.txt",
          sequence.name()));
    }
    if (k == 0 || *stamp_ns > *sequence.stamp_ns(k - 1)) continue;
    throw UsageError(
        fmt::format("TUM rows (a file called *.tum, or tum:FILE) are in the order of their "
                    "stamps, but that of scan {} of {} is not after the one before, expected "
                    "kitti:FILE or a file called *.txt, which have no stamps",
                    sequence.stem(k), sequence.name()));
  }
}

nlohmann::ordered_json scans_json(const Sequence& sequence, const std::vector<ScanPose>& poses) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const ScanPose& pose = poses[k];
    scans.push_back({{"stem", sequence.stem(k)},
                     {"map_from_sensor", rows_json(pose.map_from_sensor.matrix().topRows<3>())},
                     {"covariance", rows_json(pose.covariance)},
                     {"geometry", pose.geometry},
                     {"condition", pose.condition},
                     {"overlap", pose.overlap},
                     {"registered_points", pose.registered_points},
                     {"doubt", pose.doubtful() ? nlohmann::ordered_json(pose.doubt) : nullptr}});
  }
  return scans;
}

nlohmann::ordered_json scans_json(const Sequence& sequence) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (const ScanEntry& scan : sequence.recording().scans) {
    scans.push_back({{"stem", scan.stem},
                     {"map_from_sensor", rows_json(scan.map_from_sensor.matrix().topRows<3>())},
                     {"doubt", nullptr}});
  }
  return scans;
}

std::string tum_rows(const std::vector<std::int64_t>& stamps_ns, const std::vector<Pose>& poses) {
  std::string rows;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose& pose = poses[k];
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
    rows += fmt::format("{} {} {} {} {} {} {} {}\n", seconds_text(stamps_ns.at(k)),
                        pose.translation().x(), pose.translation().y(), pose.translation().z(),
                        q.x(), q.y(), q.z(), q.w());
  }
  return rows;
}

std::vector<Pose> poses_of(const FoundPoses& found) {
  std::vector<Pose> poses;
  for (const auto& scan : found.scans) {
    Pose& pose = poses.emplace_back(Pose::Identity());
    for (std::size_t i = 0; i < 12; ++i) {
      pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
          scan.at("map_from_sensor").at(i / 4).at(i % 4).get<double>();
    }
  }
  return poses;
}

std::string pose_rows(const FoundPoses& found, bool as_tum) {
  const std::vector<Pose> poses = poses_of(found);
  if (!as_tum) return format_poses(poses);
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    stamps_ns.push_back(found.sequence.stamp_ns(k).value());
  }
  return tum_rows(stamps_ns, poses);
}

std::vector<DoubtfulPose> doubtful_poses(const FoundPoses& found) {
  std::vector<DoubtfulPose> doubtful;
  for (const auto& scan : found.scans) {
    if (scan.at("doubt").is_null()) continue;
    doubtful.push_back({scan.at("stem").get<std::string>(), scan.at("doubt").get<std::string>()});
  }
  return doubtful;
}

std::string found_text(const FoundPoses& found, std::string_view odometry) {
  constexpr std::size_t kListed = 10;
  const std::vector<DoubtfulPose> doubtful = doubtful_poses(found);
  std::string text = fmt::format("{}: {} by {} in {}, {} doubtful\n", found.sequence.name(),
                                 counted(found.scans.size(), "pose"), odometry, found.file.string(),
                                 doubtful.size());
  for (const auto& [stem, doubt] : std::span(doubtful).first(std::min(kListed, doubtful.size()))) {
    text += fmt::format("  scan {}: {}\n", stem, doubt);
  }
  if (doubtful.size() > kListed) {
    text += fmt::format("  and {} more\n", doubtful.size() - kListed);
  }
  return text;
}

nlohmann::ordered_json found_json(const FoundPoses& found) {
  return {{"sequence", found.sequence.name()},
          {"file", found.file.string()},
          {"doubtful", doubtful_poses(found).size()},
          {"scans", found.scans}};
}

}  // namespace mosbench
