#include "core/tsdf/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace mosbench::tsdf {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::size_t kFewestReturns = 1000;
constexpr int kSectors = 720;
// Two returns of one beam in a sector, or of a comb seen through noise.
constexpr double kSameBeamDeg = 0.05;
// Quartiles of spacings at random (exponential) differ by a factor of 4.8, of HDL-64E's comb, which
// is half as dense at its lower end, by 1.6.
constexpr double kScatterOfRandom = 3.0;
constexpr double kRosettePixelDeg = 1.0;
constexpr double kBelowEdgeRows = 0.25;

struct Direction {
  double azimuth_deg, elevation_deg;
};

std::vector<Direction> directions_of(std::span<const Point> points, double min_range_m) {
  std::vector<Direction> directions;
  for (const Point& point : points) {
    const double x = point.x, y = point.y, z = point.z;
    const double range_m = std::sqrt(x * x + y * y + z * z);
    if (!std::isfinite(range_m) || range_m <= min_range_m || range_m == 0) continue;
    const double azimuth_deg = std::atan2(-y, x) * kDegrees;
    directions.push_back(
        {azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg, std::asin(z / range_m) * kDegrees});
  }
  return directions;
}

double quantile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

/// Returns the spacings of elevations that follow one another in a sector of azimuth.
std::vector<double> spacings_deg(const std::vector<Direction>& directions) {
  std::vector<std::vector<double>> sectors(kSectors);
  for (const Direction& direction : directions) {
    const auto sector = static_cast<std::size_t>(direction.azimuth_deg / 360 * kSectors);
    sectors[std::min<std::size_t>(sector, kSectors - 1)].push_back(direction.elevation_deg);
  }
  std::vector<double> spacings;
  for (std::vector<double>& elevations : sectors) {
    std::ranges::sort(elevations);
    for (std::size_t i = 1; i < elevations.size(); ++i) {
      const double spacing = elevations[i] - elevations[i - 1];
      if (spacing > kSameBeamDeg) spacings.push_back(spacing);
    }
  }
  return spacings;
}

/// Returns how many columns a full turn has when the fullest row has a return in each of its own.
int columns_of(const std::vector<Direction>& directions, const SensorModel& sensor) {
  std::vector<int> in_row(static_cast<std::size_t>(sensor.rows));
  std::vector<bool> seen(360);
  for (const Direction& direction : directions) {
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
  const std::vector<Direction> directions = directions_of(points, config.min_range_m);
  if (directions.size() < kFewestReturns) return std::nullopt;
  std::vector<double> spacings = spacings_deg(directions);
  if (spacings.size() < kFewestReturns / 10) return std::nullopt;
  SensorModel sensor;
  sensor.has_beams = quantile(spacings, 0.75) < kScatterOfRandom * quantile(spacings, 0.25);
  const double row_deg = sensor.has_beams ? quantile(spacings, 0.5) : kRosettePixelDeg;
  std::vector<double> elevations;
  for (const Direction& direction : directions) elevations.push_back(direction.elevation_deg);
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
