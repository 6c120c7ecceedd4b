#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/formats/pose_file.hpp"

namespace mosbench {

/// The poses of one sequence, map_from_sensor.
struct PosePath {
  std::string name;             ///< of the sequence, or the file's without extension
  std::filesystem::path place;  ///< the file, or the data set
  bool of_data_set = false;     ///< in the lidar's frame then, whatever its files hold
  PoseList list;                ///< stamps also where those of the data set's scans increase
};

/// Reads the poses of a file; of a folder of `mosbench run --odometry`, which has poses.txt beside
/// the results; of a data set's sequences; or of all files .txt, .csv and .tum in and below another
/// folder. They are ordered by name, or as the data set orders its sequences. Poses of Dynablox's
/// rollouts are inverted. Throws DataError if there are none, and for two files of one name.
std::vector<PosePath> read_pose_paths(const std::filesystem::path& path,
                                      std::optional<PoseFormat> format);

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

/// The poses of two places, see `read_pose_paths`: one and one, whatever their names, else those of
/// the same name, in the order of the estimates. Poses with stamps on both sides are paired by
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
