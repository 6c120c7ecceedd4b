#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.hpp"

namespace mosbench {

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

inline constexpr double kWidestAngle_rad = 0.5;

/// The angle alpha within which directions are neighbours. It has to reach from one row of beams to
/// the next, or a direction has neighbours in its own row alone.
class NeighbourAngle {
 public:
  /// At least `least_rows` times the spacing of the sensor's rows; 0: as it is set.
  NeighbourAngle(double set_rad, double least_rows) : rad_(set_rad), least_rows_(least_rows) {}

  /// Measures the spacing in the first scan that has enough returns beyond min_range_m to tell.
  void measure(std::span<const Point> points, double min_range_m);

  double rad() const { return rad_; }
  /// Says whether the angle was widened.
  std::vector<std::string> remarks() const;

 private:
  double rad_, least_rows_;
  double row_deg_ = 0;  // where the angle was widened
  bool is_measured_ = false;
};

}  // namespace mosbench
