#pragma once

#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

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

}  // namespace mosbench
