#include "datasets/sequence/sensor_guess.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

double at_share(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Counts groups of elevations with gaps between that are clearly wider than a group.
std::optional<std::size_t> rings_of(const std::vector<double>& sorted_deg) {
  constexpr double kGap_deg = 0.08, kWidest_deg = 0.05;
  constexpr std::size_t kFewest = 2, kMost = 256;
  std::size_t rings = 1, wide = 0;
  double from_deg = sorted_deg.front();
  for (std::size_t i = 1; i < sorted_deg.size(); ++i) {
    const bool is_next = sorted_deg[i] - sorted_deg[i - 1] > kGap_deg;
    if (is_next) {
      ++rings;
      from_deg = sorted_deg[i];
    }
    wide += sorted_deg[i] - from_deg > kWidest_deg ? 1U : 0U;
  }
  const bool is_clear = rings >= kFewest && rings <= kMost && 10 * wide < sorted_deg.size();
  return is_clear ? std::optional(rings) : std::nullopt;
}

}  // namespace

SensorGuess guess_sensor(std::span<const Point> points) {
  SensorGuess guess;
  std::vector<double> ranges_m, elevations_deg;
  std::vector<bool> seen(360, false);
  for (const Point& point : points) {
    if (!is_return(point)) {
      ++guess.missing;
      continue;
    }
    const double x = point.x, y = point.y, z = point.z;
    ranges_m.push_back(range_m(point));
    elevations_deg.push_back(kDegrees * std::atan2(z, std::hypot(x, y)));
    const double azimuth_deg = kDegrees * std::atan2(y, x) + 180.0;
    seen[std::min<std::size_t>(static_cast<std::size_t>(azimuth_deg), seen.size() - 1)] = true;
  }
  guess.returns = ranges_m.size();
  if (ranges_m.empty()) return guess;
  std::ranges::sort(ranges_m);
  std::ranges::sort(elevations_deg);
  guess.nearest_m = ranges_m.front();
  guess.median_m = at_share(ranges_m, 0.5);
  guess.farthest_m = ranges_m.back();
  guess.lowest_deg = at_share(elevations_deg, 0.001);
  guess.highest_deg = at_share(elevations_deg, 0.999);
  guess.around_deg = static_cast<double>(std::ranges::count(seen, true));
  guess.rings = rings_of(elevations_deg);
  return guess;
}

}  // namespace mosbench
