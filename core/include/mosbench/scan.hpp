#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace mosbench {

/// One LiDAR return in the sensor frame, metres; the memory layout of a SemanticKITTI .bin record.
struct Point {
  float x, y, z, intensity;
};
static_assert(sizeof(Point) == 16);

/// map_from_sensor, read by cancellation: p_map = map_from_sensor * p_sensor. Metres.
using Pose = Eigen::Isometry3d;

/// The two label ids that SemanticKITTI-MOS files hold for predictions.
inline constexpr std::uint32_t kStaticLabel = 9;
inline constexpr std::uint32_t kMovingLabel = 251;

}  // namespace mosbench
