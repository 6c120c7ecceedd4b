#pragma once

#include <filesystem>
#include <memory>

#include "datasets/rosbag/bag_reader.hpp"

namespace mosbench {

/// Returns whether a file is named as a bag (.bag, .mcap, .db3, each of ROS 2 also with .zstd after
/// it) or begins as one.
bool is_bag_file(const std::filesystem::path& path);

/// Returns whether a folder is a ROS 2 bag: it holds rosbag2's metadata.yaml.
bool is_bag_folder(const std::filesystem::path& path);

/// Opens a ROS 1 bag, a file or a folder of ROS 2, told apart by their bytes. Throws DataError.
std::unique_ptr<const BagReader> open_bag(const std::filesystem::path& path);

}  // namespace mosbench
