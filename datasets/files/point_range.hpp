#pragma once

#include <cmath>
#include <mosbench/scan.hpp>

namespace mosbench {

/// Returns the distance of a point from the sensor, metres, computed in double.
inline double range_m(const Point& point) {
  const double x = point.x, y = point.y, z = point.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Returns where a point is in the sensor's frame, metres.
inline Eigen::Vector3d position_of(const Point& point) { return {point.x, point.y, point.z}; }

inline bool is_finite(const Point& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

}  // namespace mosbench
