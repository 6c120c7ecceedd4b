#pragma once

#include <mosbench/scan.hpp>
#include <optional>
#include <span>

#include "core/tsdf/config.hpp"

namespace mosbench::tsdf {

/// How a sensor's directions are arranged in rows and columns. Row 0 is the highest; columns run
/// clockwise seen from above. Nothing is seen in the first and the last one, so they should lie
/// where a sensor that does not turn does not look.
struct SensorModel {
  int rows = 0;           ///< V
  int columns = 0;        ///< H, in a full turn
  double down_deg = 0;    ///< elevation of the lowest row
  double up_deg = 0;      ///< elevation of row 0
  double first_deg = 0;   ///< where columns begin, -180 to 180 from x > 0, y = 0 on
  bool has_beams = true;  ///< false: square pixels, as rosettes have no rows

  bool operator==(const SensorModel&) const = default;
  /// Returns the rays that meet a voxel at 1 m, K = (v H / 2 pi) (v V / field of view).
  double rays_per_voxel_at_1m(double voxel_size_m) const;
};

/// Returns the model that is configured; nullopt when anything of it is to be measured.
std::optional<SensorModel> configured_sensor(const Config& config);

/// Returns a model with what is configured, and the rest from the returns of a scan beyond
/// min_range_m; nullopt if these are too few (1000) to tell. Within half a degree of azimuth the
/// elevations of a spinning sensor are a comb: rows have its median spacing, and there are as many
/// columns as the fullest row has returns. If spacings scatter as at random, the sensor has no
/// rows. Then it gets square pixels, wide enough for one return in the mean; the first lies in the
/// middle of where it sees nothing.
std::optional<SensorModel> measured_sensor(std::span<const Point> points, const Config& config);

}  // namespace mosbench::tsdf
