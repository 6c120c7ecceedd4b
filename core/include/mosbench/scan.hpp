#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

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

/// Where the rays of a scan start that several sensors measured. Empty: all start at the origin of
/// the points' frame.
struct RayOrigins {
  std::vector<Eigen::Vector3d> positions_m;  ///< of at most 256 sensors, in the points' frame
  std::vector<std::uint8_t> of_point;        ///< an index of positions_m for each point

  /// Whether all rays start at the origin of the points' frame.
  bool empty() const { return of_point.empty(); }
  /// Returns where the ray of a point starts, in metres.
  Eigen::Vector3d at(std::size_t point) const {
    return empty() ? Eigen::Vector3d::Zero() : positions_m[of_point[point]];
  }
};

/// Label of a static point, as in the prediction files of SemanticKITTI-MOS.
inline constexpr std::uint32_t kStaticLabel = 9;
/// Label of a moving point.
inline constexpr std::uint32_t kMovingLabel = 251;

}  // namespace mosbench
