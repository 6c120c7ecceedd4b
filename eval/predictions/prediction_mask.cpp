#include "eval/predictions/prediction_mask.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "datasets/text/errors.hpp"
#include "eval/protocols/confusion.hpp"

namespace mosbench {
namespace {

// Limits that configurations of published methods use.
constexpr std::array kLowest_m = {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0};
constexpr std::array kHighest_m = {-1.0, 20.0, 25.0, 30.0,  40.0,  50.0,  60.0,
                                   70.0, 75.0, 80.0, 100.0, 120.0, 150.0, 200.0};

std::vector<double> ranges_of(const MaskedScan& scan) {
  std::vector<double> ranges_m;
  for (const Point& point : scan.points) ranges_m.push_back(range_m(point, Arithmetic::kDouble));
  std::ranges::sort(ranges_m);
  return ranges_m;
}

/// Returns the first and one past the last position of the sorted ranges within the mask.
std::pair<std::size_t, std::size_t> within(const std::vector<double>& ranges_m,
                                           const RangeGate& mask) {
  const auto first = std::ranges::lower_bound(ranges_m, mask.min_m);
  const auto last =
      mask.max_m <= 0.0 ? ranges_m.end() : std::ranges::upper_bound(ranges_m, mask.max_m);
  return {static_cast<std::size_t>(first - ranges_m.begin()),
          static_cast<std::size_t>(last - ranges_m.begin())};
}

}  // namespace

RangeGate find_mask(std::span<const MaskedScan> scans) {
  std::vector<std::vector<double>> sorted;
  for (const MaskedScan& scan : scans) sorted.push_back(ranges_of(scan));
  std::optional<RangeGate> found;
  for (const double min_m : kLowest_m) {
    for (const double max_m : kHighest_m) {
      const RangeGate mask{min_m, max_m};
      bool fits = true;
      bool same_points = true;
      for (std::size_t i = 0; i < scans.size() && fits; ++i) {
        const auto [first, end] = within(sorted[i], mask);
        fits = end >= first && end - first == scans[i].labels;
        same_points = same_points && found && within(sorted[i], *found) == std::pair{first, end};
      }
      if (!fits) continue;
      if (found && !same_points) {
        throw DataError(scans.front().file, "fits several range limits",
                        "--format label-masked:MIN,MAX");
      }
      if (!found) found = mask;
    }
  }
  if (found) return *found;
  throw DataError(
      scans.front().file,
      fmt::format("has {} labels for {} points, and no common range limits leave that many",
                  scans.front().labels, scans.front().points.size()),
      "a label per point, or --format label-masked:MIN,MAX");
}

std::string mask_text(const RangeGate& mask) {
  return mask.max_m <= 0.0 ? fmt::format("from {:g} m", mask.min_m)
                           : fmt::format("{:g} to {:g} m", mask.min_m, mask.max_m);
}

std::vector<std::uint32_t> spread_over_scan(std::span<const std::uint32_t> labels,
                                            std::span<const Point> points, const RangeGate& mask,
                                            const std::filesystem::path& file) {
  std::vector<std::uint32_t> spread(points.size(), kStaticLabel);
  std::size_t used = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!mask.contains(range_m(points[i], Arithmetic::kDouble))) continue;
    if (used < labels.size()) spread[i] = labels[used];
    ++used;
  }
  if (used == labels.size()) return spread;
  throw DataError(file, fmt::format("has {} labels", labels.size()),
                  fmt::format("one for each of the {} points {}", used, mask_text(mask)));
}

}  // namespace mosbench
