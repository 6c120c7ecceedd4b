#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string_view>
#include <vector>

#include "datasets/files/point_records.hpp"
#include "datasets/rosbag/ros_messages.hpp"

namespace mosbench {

/// The points of a PointCloud2 in the order in which they lie in memory, none dropped.
struct TimedCloud {
  std::int64_t stamp_ns = 0;
  std::vector<Point> points;
  /// When each was measured, since the stamp; empty when the message does not tell. From field "t"
  /// (integer nanoseconds, Ouster) or "time" (float seconds, Velodyne).
  std::vector<std::int64_t> times_ns;
};

/// Fields are found by name, at any offset and of any numeric type; intensity is 0 when there is
/// none. Throws DataError when x, y or z is missing or no single number, or a field lies beyond
/// the point.
TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file);

/// Whether `head` names a field from which `parse_cloud` takes times.
bool has_times(const CloudHead& head);

}  // namespace mosbench
