#include "core/tsdf/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/beam_rows.hpp"

namespace mosbench::tsdf {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kRosettePixelDeg = 1.0;
constexpr double kBelowEdgeRows = 0.25;

/// Returns how many columns a full turn has when the fullest row has a return in each of its own.
int columns_of(const std::vector<BeamDirection>& directions, const SensorModel& sensor) {
  std::vector<int> in_row(static_cast<std::size_t>(sensor.rows));
  std::vector<bool> seen(360);
  for (const BeamDirection& direction : directions) {
    const double row = (sensor.up_deg - direction.elevation_deg) /
                       (sensor.up_deg - sensor.down_deg) * (sensor.rows - 1);
    if (row < 0 || row >= sensor.rows) continue;
    ++in_row[static_cast<std::size_t>(row)];
    seen[std::min<std::size_t>(static_cast<std::size_t>(direction.azimuth_deg), 359)] = true;
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
  const double row_deg = sensor.has_beams ? spacing->degrees : kRosettePixelDeg;
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
                                      : static_cast<int>(360 / kRosettePixelDeg);
  }
  return sensor;
}

}  // namespace mosbench::tsdf
