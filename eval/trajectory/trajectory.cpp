#include "eval/trajectory/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

PoseList read_in_map_frame(const std::filesystem::path& file, std::optional<PoseFormat> format) {
  PoseList list = read_pose_list(file, format);
  if (list.poses.empty()) throw DataError(file, "holds no pose", "one row per scan");
  if (list.format == PoseFormat::kRollout) {
    for (Pose& pose : list.poses) pose = pose.inverse();
  }
  return list;
}

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

bool holds_poses(const std::filesystem::path& file) {
  const std::filesystem::path extension = file.extension();
  return extension == ".txt" || extension == ".csv" || extension == ".tum";
}

std::map<std::string, std::filesystem::path> pose_files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_regular_file() || !holds_poses(entry.path())) continue;
    if (!files.emplace(entry.path().stem().string(), entry.path()).second) {
      throw DataError(entry.path(), "another file has the same name but for its extension",
                      "one file of poses per sequence");
    }
  }
  return files;
}

}  // namespace

std::vector<double> path_lengths_m(const std::vector<Pose>& poses) {
  std::vector<double> lengths_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    lengths_m[i] = lengths_m[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths_m;
}

TrajectoryPair read_trajectory_pair(const std::filesystem::path& estimate,
                                    const std::filesystem::path& truth,
                                    const TrajectoryOptions& options) {
  PoseList estimated = read_in_map_frame(estimate, options.format);
  PoseList known = read_in_map_frame(truth, options.format);
  TrajectoryPair pair{.name = estimate.stem().string(), .estimate = {}, .truth = {}, .remarks = {}};
  if (!estimated.stamps_ns.empty() && !known.stamps_ns.empty()) {
    pair_by_time(estimated, known, estimate, options.max_time_difference_s, pair);
  } else if (estimated.poses.size() != known.poses.size()) {
    throw DataError(
        estimate, fmt::format("holds {} poses", estimated.poses.size()),
        fmt::format("{} as in {}, or stamps in both files", known.poses.size(), truth.string()));
  } else {
    pair.estimate = std::move(estimated.poses);
    pair.truth = std::move(known.poses);
    pair.remarks.emplace_back("poses are paired row by row");
  }
  if (options.camera == CameraFrame::kEstimate) to_camera(pair.truth, *options.camera_from_lidar);
  if (options.camera == CameraFrame::kTruth) to_camera(pair.estimate, *options.camera_from_lidar);
  return pair;
}

std::vector<TrajectoryPair> read_trajectory_pairs(const std::filesystem::path& estimates,
                                                  const std::filesystem::path& truths,
                                                  const TrajectoryOptions& options) {
  const bool folders = std::filesystem::is_directory(estimates);
  if (folders != std::filesystem::is_directory(truths)) {
    throw DataError(truths, folders ? "is no folder" : "is a folder",
                    "two files or two folders of files");
  }
  if (!folders) return {read_trajectory_pair(estimates, truths, options)};
  const auto known = pose_files_of(truths);
  std::vector<TrajectoryPair> pairs;
  for (const auto& [name, file] : pose_files_of(estimates)) {
    const auto truth = known.find(name);
    if (truth == known.end()) {
      throw DataError(file, "has no truth of its name in " + truths.string(),
                      "a file of poses of the same name");
    }
    pairs.push_back(read_trajectory_pair(file, truth->second, options));
  }
  if (pairs.empty()) throw DataError(estimates, "holds no poses", "files .txt, .csv or .tum");
  return pairs;
}

}  // namespace mosbench
