#include "eval/trajectory/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/trajectory/frame_check.hpp"
#include "eval/trajectory/pose_paths.hpp"

namespace mosbench {
namespace {

void to_camera(std::vector<Pose>& poses, const Pose& camera_from_lidar) {
  const Pose lidar_from_camera = camera_from_lidar.inverse();
  for (Pose& pose : poses) pose = camera_from_lidar * pose * lidar_from_camera;
}

std::size_t nearest_stamp(const std::vector<std::int64_t>& stamps_ns, std::int64_t stamp_ns) {
  const auto behind = std::ranges::lower_bound(stamps_ns, stamp_ns);
  const auto i = static_cast<std::size_t>(behind - stamps_ns.begin());
  if (i == stamps_ns.size()) return i - 1;
  return i > 0 && stamp_ns - stamps_ns[i - 1] <= stamps_ns[i] - stamp_ns ? i - 1 : i;
}

/// Positions in the lists of poses with about the same stamp.
std::vector<std::pair<std::size_t, std::size_t>> paired_by_time(
    const std::vector<std::int64_t>& shorter, const std::vector<std::int64_t>& longer,
    double max_difference_s) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    const std::size_t j = nearest_stamp(longer, shorter[i]);
    const double difference_s = std::abs(static_cast<double>(longer[j] - shorter[i])) * 1e-9;
    if (difference_s <= max_difference_s) pairs.emplace_back(i, j);
  }
  return pairs;
}

void pair_by_time(const PoseList& estimate, const PoseList& truth,
                  const std::filesystem::path& file, double max_difference_s,
                  TrajectoryPair& pair) {
  const bool estimate_shorter = estimate.poses.size() <= truth.poses.size();
  const PoseList& shorter = estimate_shorter ? estimate : truth;
  const PoseList& longer = estimate_shorter ? truth : estimate;
  for (const auto& [i, j] : paired_by_time(shorter.stamps_ns, longer.stamps_ns, max_difference_s)) {
    pair.estimate.push_back(estimate.poses[estimate_shorter ? i : j]);
    pair.truth.push_back(truth.poses[estimate_shorter ? j : i]);
  }
  if (pair.estimate.empty()) {
    throw DataError(file, "has no stamp near one of the truth",
                    fmt::format("stamps at most {} s apart", max_difference_s));
  }
  pair.remarks.push_back(fmt::format("{} of {} estimated and {} true poses are paired by stamps",
                                     pair.estimate.size(), estimate.poses.size(),
                                     truth.poses.size()));
}

void check_camera(const PosePath& path, bool is_camera, const char* flag) {
  if (!is_camera || !path.of_data_set) return;
  throw UsageError(fmt::format(
      "--camera {}: the poses of {} are read as the lidar's, expected this of files only", flag,
      path.place.string()));
}

TrajectoryPair paired(PosePath estimate, PosePath truth, const TrajectoryOptions& options) {
  check_camera(estimate, options.camera == CameraFrame::kEstimate, "estimate");
  check_camera(truth, options.camera == CameraFrame::kTruth, "truth");
  TrajectoryPair pair{.name = estimate.name, .estimate = {}, .truth = {}, .remarks = {}};
  if (!estimate.list.stamps_ns.empty() && !truth.list.stamps_ns.empty()) {
    pair_by_time(estimate.list, truth.list, estimate.place, options.max_time_difference_s, pair);
  } else if (estimate.list.poses.size() != truth.list.poses.size()) {
    throw DataError(estimate.place, "holds " + counted(estimate.list.poses.size(), "pose"),
                    fmt::format("{} as in {}, or stamps in both as in .tum files",
                                truth.list.poses.size(), truth.place.string()));
  } else {
    pair.estimate = std::move(estimate.list.poses);
    pair.truth = std::move(truth.list.poses);
    pair.remarks.emplace_back("poses are paired row by row");
  }
  if (options.camera == CameraFrame::kEstimate) to_camera(pair.truth, *options.camera_from_lidar);
  if (options.camera == CameraFrame::kTruth) to_camera(pair.estimate, *options.camera_from_lidar);
  if (auto remark = frame_remark(pair, options)) pair.remarks.push_back(std::move(*remark));
  return pair;
}

}  // namespace

std::vector<double> path_lengths_m(const std::vector<Pose>& poses) {
  std::vector<double> lengths_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    lengths_m[i] = lengths_m[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths_m;
}

std::vector<TrajectoryPair> read_trajectory_pairs(const std::filesystem::path& estimates,
                                                  const std::filesystem::path& truths,
                                                  const TrajectoryOptions& options) {
  std::vector<PosePath> estimated = read_pose_paths(estimates, options.format);
  std::vector<PosePath> known = read_pose_paths(truths, options.format);
  if (estimated.size() == 1 && known.size() == 1) {
    return {paired(std::move(estimated.front()), std::move(known.front()), options)};
  }
  std::vector<TrajectoryPair> pairs;
  for (PosePath& estimate : estimated) {
    const auto truth = std::ranges::find(known, estimate.name, &PosePath::name);
    if (truth == known.end()) {
      throw DataError(
          estimate.place,
          fmt::format("\"{}\" has no truth of its name in {}", estimate.name, truths.string()),
          "poses of the same name there");
    }
    pairs.push_back(paired(std::move(estimate), std::move(*truth), options));
  }
  return pairs;
}

}  // namespace mosbench
