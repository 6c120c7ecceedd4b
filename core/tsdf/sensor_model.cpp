#include "core/tsdf/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/voxel/directions.hpp"

namespace mosbench::tsdf {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kBelowEdgeRows = 0.25;

std::size_t whole_degree(const BeamDirection& direction) {
  return std::min<std::size_t>(static_cast<std::size_t>(direction.azimuth_deg), 359);
}

/// Returns the middle of the widest gap of azimuths without a return, -180 to 180; 0 without a gap.
double middle_of_gap_deg(const std::vector<BeamDirection>& directions) {
  std::vector<bool> seen(360);
  for (const BeamDirection& direction : directions) seen[whole_degree(direction)] = true;
  int widest = 0, gap = 0;
  double middle_deg = 0;
  for (int degree = 0; degree < 720; ++degree) {  // twice around: a gap may span 0
    gap = seen[static_cast<std::size_t>(degree % 360)] ? 0 : gap + 1;
    if (gap <= widest) continue;
    widest = gap;
    middle_deg = degree + 1 - gap / 2.0;
  }
  return std::remainder(middle_deg, 360);
}

/// Returns the edge of pixels that hold one return in the mean, where there are any: counted by
/// whole degrees of azimuth and elevation. docs/methods/dynablox.md has figures.
double rosette_pixel_deg(const std::vector<BeamDirection>& directions) {
  std::vector<bool> seen(360 * 181);
  for (const BeamDirection& direction : directions) {
    const auto elevation = static_cast<std::size_t>(direction.elevation_deg + 90);
    seen[elevation * 360 + whole_degree(direction)] = true;
  }
  const auto degrees_sq = static_cast<double>(std::ranges::count(seen, true));
  return std::sqrt(degrees_sq / static_cast<double>(directions.size()));
}

/// Returns how many columns a full turn has when the fullest row has a return in each of its own.
int columns_of(const std::vector<BeamDirection>& directions, const SensorModel& sensor) {
  std::vector<int> in_row(static_cast<std::size_t>(sensor.rows));
  std::vector<bool> seen(360);
  for (const BeamDirection& direction : directions) {
    const double row = (sensor.up_deg - direction.elevation_deg) /
                       (sensor.up_deg - sensor.down_deg) * (sensor.rows - 1);
    if (row < 0 || row >= sensor.rows) continue;
    ++in_row[static_cast<std::size_t>(row)];
    seen[whole_degree(direction)] = true;
  }
  const auto degrees =
      static_cast<double>(std::max<std::ptrdiff_t>(std::ranges::count(seen, true), 1));
  const double columns = *std::ranges::max_element(in_row) * 360.0 / degrees;
  return static_cast<int>(std::clamp(columns, 36.0, 8192.0));
}

}  // namespace

double SensorModel::rays_per_voxel_at_1m(double voxel_size_m) const {
  const double field_rad = (up_deg - down_deg) / kDegrees;
  return (voxel_size_m * columns / (2 * std::numbers::pi)) * (voxel_size_m * rows / field_rad);
}

std::optional<SensorModel> configured_sensor(const Config& config) {
  if (config.measures_sensor()) return std::nullopt;
  return SensorModel{.rows = config.range_image_rows,
                     .columns = config.range_image_columns,
                     .down_deg = config.field_of_view_down_deg,
                     .up_deg = config.field_of_view_up_deg};
}

std::optional<SensorModel> measured_sensor(std::span<const Point> points, const Config& config) {
  const std::vector<BeamDirection> directions = beam_directions(points, config.min_range_m);
  const std::optional<RowSpacing> spacing = row_spacing(directions);
  if (!spacing) return std::nullopt;
  SensorModel sensor;
  sensor.has_beams = spacing->is_regular;
  if (!sensor.has_beams) sensor.first_deg = middle_of_gap_deg(directions);
  const double row_deg = sensor.has_beams ? spacing->degrees : rosette_pixel_deg(directions);
  std::vector<double> elevations;
  for (const BeamDirection& direction : directions) elevations.push_back(direction.elevation_deg);
  sensor.down_deg = config.field_of_view_down_deg;
  sensor.up_deg = config.field_of_view_up_deg;
  if (sensor.down_deg == 0 && sensor.up_deg == 0) {
    // Points fall into the row whose upper edge they are below: beams shall lie well inside, and
    // near the edge, from which depths are interpolated to the next row.
    sensor.down_deg = quantile(elevations, 0.001) + kBelowEdgeRows * row_deg;
    sensor.up_deg = quantile(elevations, 0.999) + kBelowEdgeRows * row_deg;
  }
  if (!(sensor.up_deg > sensor.down_deg)) return std::nullopt;
  const double rows = std::round((sensor.up_deg - sensor.down_deg) / row_deg) + 1;
  sensor.rows = config.range_image_rows > 0 ? config.range_image_rows
                                            : static_cast<int>(std::clamp(rows, 2.0, 1024.0));
  sensor.columns = config.range_image_columns;
  if (sensor.columns == 0) {
    sensor.columns = sensor.has_beams ? columns_of(directions, sensor)
                                      : static_cast<int>(std::min(360 / row_deg, 8192.0));
  }
  return sensor;
}

}  // namespace mosbench::tsdf
