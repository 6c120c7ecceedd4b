#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>

namespace mosbench {

/// What the returns of a scan show of the sensor that measured it.
struct SensorGuess {
  std::size_t returns = 0, missing = 0;  ///< missing: at the origin, or not finite
  double nearest_m = 0.0, median_m = 0.0, farthest_m = 0.0;
  double lowest_deg = 0.0, highest_deg = 0.0;  ///< elevation of all but one in a thousand returns
  double around_deg = 0.0;                     ///< directions with returns, seen from above
  /// Elevations that all returns lie at; nothing where they lie at many, as of solid-state sensors
  /// and of those whose lasers sit apart.
  std::optional<std::size_t> rings;
};

SensorGuess guess_sensor(std::span<const Point> points);

}  // namespace mosbench
