#pragma once

#include <cmath>
#include <limits>
#include <mosbench/scan.hpp>

namespace mosbench {

/// Returns the distance of a point from the sensor, metres, computed in double.
inline double range_m(const Point& point) {
  const double x = point.x, y = point.y, z = point.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Returns where a point is in the sensor's frame, metres.
inline Eigen::Vector3d position_of(const Point& point) { return {point.x, point.y, point.z}; }

/// Returns how far apart float32 numbers are that lie `at_m` from zero or just beyond.
inline float float_step_m(float at_m) {
  return std::nextafter(at_m, std::numeric_limits<float>::infinity()) - at_m;
}

inline bool is_finite(const Point& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

/// Returns whether a point is a return: finite and not (0, 0, 0).
inline bool is_return(const Point& point) {
  return is_finite(point) && (point.x != 0 || point.y != 0 || point.z != 0);
}

}  // namespace mosbench
