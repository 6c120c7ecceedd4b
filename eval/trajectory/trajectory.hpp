#pragma once

#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "eval/result/result.hpp"

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
  std::vector<NamedMark> marks{};    ///< of the data that both are of
};

/// The poses of two places, `estimates` and `truths`: one and one, whatever their names, else those
/// of the same name, in the order of the estimates. Poses with stamps on both sides are paired by
/// time: for each of the shorter list the nearest of the longer one, if near enough. Otherwise row
/// by row. Poses of the lidar are taken to the camera where the other file is the camera's. Throws
/// DataError for an estimate without truth, another number of rows, and no common stamps;
/// UsageError where a data set is said to be the camera's.
std::vector<TrajectoryPair> read_trajectory_pairs(const std::filesystem::path& estimates,
                                                  const std::filesystem::path& truths,
                                                  const TrajectoryOptions& options);

/// Length of the path up to each pose, metres; 0 for the first.
std::vector<double> path_lengths_m(const std::vector<Pose>& poses);

/// Says that the motions of an estimate fit the truth far better if one of the two is turned into
/// the axes of a camera, or is not: a wrong --camera. Without a Tr in `options` the axes are those
/// of KITTI's cameras (x right, z ahead). Empty if the pair fits unchanged.
std::optional<std::string> frame_remark(const TrajectoryPair& pair,
                                        const TrajectoryOptions& options);

}  // namespace mosbench
