#pragma once

#include <filesystem>
#include <map>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Beside the folders of several LiDARs: where each is mounted.
inline constexpr const char* kMountsFile = "mounts.txt";

inline constexpr const char* kMountRow =
    "name tx ty tz qx qy qz qw of vehicle_from_lidar, metres, blanks between";

/// Parses a row per LiDAR, besides blank lines and comments behind #. Throws DataError naming the
/// line.
std::map<std::string, Pose> parse_mounts(std::string_view text, const std::filesystem::path& file);

}  // namespace mosbench
