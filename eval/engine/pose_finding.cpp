#include "eval/engine/pose_finding.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/sequence/posed_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/job/presets.hpp"
#include "eval/result/progress.hpp"
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
  const std::size_t doubtful = doubtful_count(scans);
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
  const std::unique_ptr<Method> method =
      filter ? filter->method->make(filter->settings,
                                    {.threads = threads, .scan_count = sequence.size()})
             : nullptr;
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
}

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans) {
  std::vector<Pose> poses;
  for (const ScanPose& scan : scans) poses.push_back(scan.map_from_sensor);
  return poses;
}

std::size_t doubtful_count(const std::vector<ScanPose>& scans) {
  return static_cast<std::size_t>(std::ranges::count_if(scans, &ScanPose::doubtful));
}

}  // namespace mosbench
