#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/formats/pose_list.hpp"

namespace mosbench {

/// The poses of one sequence, map_from_sensor.
struct PosePath {
  std::string name;             ///< of the sequence, or the file's without extension
  std::filesystem::path place;  ///< the file, or the data set
  bool of_data_set = false;     ///< in the lidar's frame then, whatever its files hold
  PoseList list;                ///< stamps also where those of the data set's scans increase
};

/// The poses of a file; of a folder of `mosbench run --odometry` the poses.txt beside the results;
/// of a data set those of its sequences; of another folder all files .txt, .csv and .tum in and
/// below it. Ordered by name, or as the data set orders its sequences. Poses of Dynablox's rollouts
/// are inverted. Throws DataError where there are none, and for two files of one name.
std::vector<PosePath> read_pose_paths(const std::filesystem::path& path,
                                      std::optional<PoseFormat> format);

}  // namespace mosbench
