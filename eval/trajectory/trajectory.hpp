#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/files/pose_list.hpp"

namespace mosbench {

/// Which of the two files of a pair is in the frame of KITTI's camera, the other being the lidar's.
enum class CameraFrame { kNeither, kEstimate, kTruth };

struct TrajectoryOptions {
  std::optional<PoseFormat> format;     ///< told from the first row when not given
  double max_time_difference_s = 0.01;  ///< between stamps of a pair
  CameraFrame camera = CameraFrame::kNeither;
  std::optional<Pose> camera_from_lidar;  ///< Tr of calib.txt; needed unless kNeither
};

/// An estimate and the truth, pose by pose.
struct TrajectoryPair {
  std::string name;  ///< the estimate's file name without extension
  std::vector<Pose> estimate, truth;
  std::vector<std::string> remarks;  ///< how poses were paired
};

/// Poses with stamps in both files are paired by time: for each of the shorter list the nearest of
/// the longer one, if near enough. Otherwise row by row. Poses of Dynablox's rollouts are inverted;
/// those of the lidar are taken to the camera where the other file is the camera's. Throws
/// DataError for files that differ in their number of rows, have no common stamps, or hold no pose.
TrajectoryPair read_trajectory_pair(const std::filesystem::path& estimate,
                                    const std::filesystem::path& truth,
                                    const TrajectoryOptions& options);

/// One pair of files; of two folders, all .txt, .csv and .tum files of the estimates' with the file
/// of the same stem, in the order of their names. Throws DataError for an estimate without truth.
std::vector<TrajectoryPair> read_trajectory_pairs(const std::filesystem::path& estimates,
                                                  const std::filesystem::path& truths,
                                                  const TrajectoryOptions& options);

/// Length of the path up to each pose, metres; 0 for the first.
std::vector<double> path_lengths_m(const std::vector<Pose>& poses);

}  // namespace mosbench
