#pragma once

#include <filesystem>
#include <map>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Beside the folders of several LiDARs: where each is mounted.
inline constexpr const char* kMountsFile = "mounts.txt";

/// Parses a row per LiDAR: its name, tx ty tz in metres and the quaternion qx qy qz qw of
/// vehicle_from_lidar. Throws DataError naming the line.
std::map<std::string, Pose> parse_mounts(std::string_view text, const std::filesystem::path& file);

}  // namespace mosbench
