#pragma once

#include <cstdint>
#include <functional>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>

namespace mosbench {

/// Returns map_from_sensor at a time in nanoseconds, or nothing where it is unknown.
using PoseAt = std::function<std::optional<Pose>(std::int64_t)>;

/// Moves every point to where the sensor at `reference_ns` would have seen it; point i was measured
/// at stamp_ns + times_ns[i] (lidar_undistortion of ethz-asl, as Dynablox uses it). Count and order
/// stay, missing returns move too, points measured at the reference keep their bits. Returns false,
/// with part of the points moved, when a pose is missing.
bool undistort(std::span<Point> points, std::span<const std::int64_t> times_ns,
               std::int64_t stamp_ns, std::int64_t reference_ns, const PoseAt& map_from_sensor);

}  // namespace mosbench
