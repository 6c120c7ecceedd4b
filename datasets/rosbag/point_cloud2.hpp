#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/formats/point_records.hpp"
#include "datasets/rosbag/ros_messages.hpp"

namespace mosbench {

/// The points of a PointCloud2 or of a CustomMsg of Livox in the order of its records, none
/// dropped.
struct TimedCloud {
  std::int64_t stamp_ns = 0;
  std::vector<Point> points;
  /// When each point was measured, since the stamp, in nanoseconds. Fields "t" (Ouster) and
  /// "offset_time" (Livox) of integers hold nanoseconds, "time" (Velodyne) of floats seconds;
  /// "timestamp" (Hesai, RoboSense, Livox) and others what `times_after_stamp_ns` finds. All 0
  /// where all are the same, empty without such a field.
  std::vector<std::int64_t> times_ns;
  std::optional<std::vector<std::uint32_t>> labels;  ///< field "label"
};

/// Parses a whole message. Fields may have any offset and any numeric type; intensity is 0 when
/// there is none. Throws DataError when x, y or z is missing or no single number, or a field lies
/// beyond the point.
TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file,
                       const MessageFormat& format = {});

/// Returns whether `head` names a field that `parse_cloud` reads times from.
bool has_times(const CloudHead& head);

}  // namespace mosbench
