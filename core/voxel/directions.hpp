#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.hpp"

namespace mosbench {

/// Where a return came from. Azimuths run clockwise seen from above, from x > 0 on, 0 to 360.
struct BeamDirection {
  double azimuth_deg, elevation_deg;
};

/// Returns the directions of the finite points beyond min_range_m.
std::vector<BeamDirection> beam_directions(std::span<const Point> points, double min_range_m);

/// Returns the value below which this share of the values lies; 0 is the least, 1 the greatest.
/// There must be a value. Reorders them.
double quantile(std::vector<double>& values, double share);

/// How far apart the rows of beams of a sensor are.
struct RowSpacing {
  double degrees;   ///< the median
  bool is_regular;  ///< false: elevations are scattered as at random, as those of rosettes
};

/// Measures the spacing in the returns of a scan; nullopt when these are too few (1000) to tell.
/// Within half a degree of azimuth the elevations of a spinning sensor are a comb.
std::optional<RowSpacing> row_spacing(std::span<const BeamDirection> directions);

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

/// b - a of two bearings in [-pi, pi], the short way round.
inline float bearing_difference_rad(float a, float b) {
  constexpr float kPi = 3.14159274F;
  const float difference = b - a;
  return difference > kPi ? difference - 2 * kPi
                          : (difference < -kPi ? difference + 2 * kPi : difference);
}

/// The finding of a reference scan about a query point.
struct Look {
  enum class Finding {
    kUnknown,   ///< it does not surround the point
    kOccupied,  ///< one of its points is too near, or before the point
    kFree       ///< it sees past the point
  };
  Finding finding = Finding::kUnknown;
  float margin_m = 0;
};

/// The points of a reference scan, sorted into cells of bearing and elevation.
class DirectionGrid {
 public:
  /// Points with the range 0 are left out.
  DirectionGrid(std::span<const Direction> points, double neighbour_angle_rad);

  /// Returns by how much the reference sees past a query point: with N the reference points n with
  /// (b_n - b)^2 + (e_n - e)^2 <= alpha^2, the least r_n - r in metres. 0 where the reference does
  /// not tell: N is empty, or the point is not inside its box, min b_n <= b <= max b_n and
  /// min e_n < e < max e_n, and where the result is below `least_m`. All in single precision.
  float free_margin_m(const Direction& query, float least_m) const {
    return look(query, least_m).margin_m;
  }
  /// Returns the same, and why it is 0.
  Look look(const Direction& query, float least_m) const;

  std::size_t memory_bytes() const;

 private:
  std::uint32_t cell_of(std::uint32_t row, std::uint32_t column) const {
    return row * columns_ + column;
  }
  std::uint32_t row_of(float elevation_rad) const;
  std::uint32_t column_of(float bearing_rad) const;

  float angle_sq_rad2_;
  float rows_per_rad_, columns_per_rad_;
  std::uint32_t rows_, columns_;
  std::vector<std::uint32_t> first_;  ///< per cell, into the arrays below; one more at the end
  std::vector<float> range_m_, bearing_rad_, elevation_rad_;  ///< with a few more at their ends
};

/// Returns what the reference says about each query, as DirectionGrid::look does.
std::vector<Look> looks_at(std::span<const Direction> queries, const DirectionGrid& reference,
                           float least_m, ThreadPool& pool);

}  // namespace mosbench
