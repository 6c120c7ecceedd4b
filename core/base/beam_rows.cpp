#include "core/base/beam_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace mosbench {
namespace {

constexpr std::size_t kFewestReturns = 1000;
constexpr int kSectors = 720;
// Two returns of one beam in a sector, or of a comb seen through noise.
constexpr double kSameBeamDeg = 0.05;
// Quartiles of spacings differ by a factor of 4.8 at random (exponential, beyond kSameBeamDeg,
// too), of 3.6 to 6.1 with simulated rosettes, and of 1.7 with HDL-64E's comb, which is half as
// dense at its lower end.
constexpr double kScatterOfRandom = 2.5;

/// Returns the spacings of elevations that follow one another in a sector of azimuth.
std::vector<double> spacings_deg(std::span<const BeamDirection> directions) {
  std::vector<std::vector<double>> sectors(kSectors);
  for (const BeamDirection& direction : directions) {
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

}  // namespace

std::vector<BeamDirection> beam_directions(std::span<const Point> points, double min_range_m) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<BeamDirection> directions;
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

std::optional<RowSpacing> row_spacing(std::span<const BeamDirection> directions) {
  if (directions.size() < kFewestReturns) return std::nullopt;
  std::vector<double> spacings = spacings_deg(directions);
  if (spacings.size() < kFewestReturns / 10) return std::nullopt;
  const double upper = quantile(spacings, 0.75) - kSameBeamDeg;
  const double lower = quantile(spacings, 0.25) - kSameBeamDeg;
  const bool is_regular = upper < kScatterOfRandom * lower;
  return RowSpacing{quantile(spacings, 0.5), is_regular};
}

}  // namespace mosbench
