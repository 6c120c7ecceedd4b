#include "datasets/rosbag/bag_turns.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kAzimuths = 36, kElevations = 8, kRuns = 3, kRunScans = 8;

/// The mean range of the points by direction, as a logarithm; 0 where there are none.
using View = std::array<double, kAzimuths * kElevations>;

View view_of(const std::vector<Point>& points) {
  View sums{};
  std::array<std::size_t, kAzimuths * kElevations> counts{};
  for (const Point& point : points) {
    const double range = range_m(point);
    if (!is_finite(point) || range < 0.5) continue;
    const double turn = (std::atan2(point.y, point.x) + M_PI) / (2.0 * M_PI);
    const double rise = (std::asin(point.z / range) + M_PI_2) / M_PI;
    const auto place = [](double share, std::size_t bins) {
      return std::min(static_cast<std::size_t>(share * static_cast<double>(bins)), bins - 1);
    };
    // Scans look at the middle quarter of elevations with most of their points.
    const double around = std::clamp(2.0 * (rise - 0.25), 0.0, 1.0);
    const std::size_t bin = place(turn, kAzimuths) * kElevations + place(around, kElevations);
    sums[bin] += std::log(1.0 + range);
    ++counts[bin];
  }
  for (std::size_t bin = 0; bin < sums.size(); ++bin) {
    if (counts[bin] > 0) sums[bin] /= static_cast<double>(counts[bin]);
  }
  return sums;
}

double difference(const View& a, const View& b) {
  double sum = 0.0;
  for (std::size_t bin = 0; bin < a.size(); ++bin) sum += std::abs(a[bin] - b[bin]);
  return sum;
}

}  // namespace

std::optional<std::string> doubt_about_turns(
    std::size_t scans, const std::function<std::vector<Point>(std::size_t)>& points_of) {
  constexpr std::size_t kFewest = 6;
  constexpr double kAlike = 0.6;
  std::size_t compared = 0, in_turn = 0;
  for (std::size_t run = 0; run < kRuns; ++run) {
    const std::size_t length = std::min(scans, kRunScans);
    std::vector<View> views;
    for (std::size_t i = 0; i < length; ++i) {
      views.push_back(view_of(points_of(run * (scans - length) / (kRuns - 1) + i)));
    }
    for (std::size_t i = 2; i < length; ++i) {
      ++compared;
      in_turn += difference(views[i - 2], views[i]) < kAlike * difference(views[i - 1], views[i]);
    }
  }
  if (compared < kFewest || 10 * in_turn < 9 * compared) return std::nullopt;
  return "every second scan looks alike, and unlike those between: two sensors, or two halves of "
         "a turn, seem to publish in turn; expected scans of one sensor";
}

}  // namespace mosbench
