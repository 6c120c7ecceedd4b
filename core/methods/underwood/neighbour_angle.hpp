#pragma once

#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

namespace mosbench::underwood {

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

}  // namespace mosbench::underwood
