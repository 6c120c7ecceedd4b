#pragma once

#include <filesystem>
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

}  // namespace mosbench
