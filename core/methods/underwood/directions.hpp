#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"

namespace mosbench::underwood {

/// A point as a sensor sees it.
struct Direction {
  float range_m = 0;        ///< 0 for points that do not take part
  float bearing_rad = 0;    ///< atan2(y, x)
  float elevation_rad = 0;  ///< asin(z / range)
};

/// A closed interval of ranges, without its lower end.
struct RangeWindow {
  double above_m, up_to_m;
};

/// Returns the points as a sensor at the origin of `reference` sees them. Those whose distance to
/// their own sensor is outside `window`, or that are not finite, get the range 0.
std::vector<Direction> directions_of(std::span<const Point> points,
                                     const Pose& reference_from_sensor, const RangeWindow& window,
                                     ThreadPool& pool);

}  // namespace mosbench::underwood
