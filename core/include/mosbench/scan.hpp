#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace mosbench {

/// One LiDAR return in the sensor frame, metres; the memory layout of a SemanticKITTI .bin record.
struct Point {
  float x;          ///< forward, where the sensor says so
  float y;          ///< left
  float z;          ///< up
  float intensity;  ///< as the sensor gives it; no method reads it
};
static_assert(sizeof(Point) == 16);

/// map_from_sensor, read by cancellation: p_map = map_from_sensor * p_sensor. Metres.
using Pose = Eigen::Isometry3d;

/// Label of a static point, as in the prediction files of SemanticKITTI-MOS.
inline constexpr std::uint32_t kStaticLabel = 9;
/// Label of a moving point.
inline constexpr std::uint32_t kMovingLabel = 251;

}  // namespace mosbench
