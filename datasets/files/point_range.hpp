#pragma once

#include <cmath>
#include <mosbench/scan.hpp>

namespace mosbench {

/// Returns the distance of a point from the sensor, metres, computed in double.
inline double range_m(const Point& point) {
  const double x = point.x, y = point.y, z = point.z;
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace mosbench
