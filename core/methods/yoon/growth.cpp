#include "core/methods/yoon/growth.hpp"

#include <algorithm>
#include <numbers>

namespace mosbench::yoon {
namespace {

struct Count {
  std::uint32_t points = 0, seeds = 0;
};

/// Pixels of bearing and elevation; there is one more row at both ends.
class Image {
 public:
  explicit Image(double pixel_rad)
      : columns_(static_cast<std::size_t>(2 * std::numbers::pi / pixel_rad)),
        columns_per_rad_(static_cast<double>(columns_) / (2 * std::numbers::pi)),
        rows_per_rad_(1 / pixel_rad),
        counts_((static_cast<std::size_t>(std::numbers::pi * rows_per_rad_) + 4) * columns_) {}

  void add(const Direction& direction, bool is_seed) {
    Count& count = counts_[row_of(direction) * columns_ + column_of(direction)];
    ++count.points;
    count.seeds += is_seed;
  }

  Count around(const Direction& direction) const {
    const std::size_t row = row_of(direction), column = column_of(direction);
    Count sum;
    for (const std::size_t r : {row - 1, row, row + 1}) {
      for (const std::size_t c : {column + columns_ - 1, column, column + 1}) {
        const Count& count = counts_[r * columns_ + c % columns_];
        sum.points += count.points;
        sum.seeds += count.seeds;
      }
    }
    return sum;
  }

 private:
  std::size_t row_of(const Direction& direction) const {
    const double from_bottom = direction.elevation_rad + std::numbers::pi / 2;
    return 1 + static_cast<std::size_t>(std::max(from_bottom, 0.0) * rows_per_rad_);
  }
  std::size_t column_of(const Direction& direction) const {
    const double from_back = direction.bearing_rad + std::numbers::pi;
    const auto column = static_cast<std::size_t>(std::max(from_back, 0.0) * columns_per_rad_);
    return std::min(column, columns_ - 1);
  }

  std::size_t columns_;
  double columns_per_rad_, rows_per_rad_;
  std::vector<Count> counts_;
};

}  // namespace

std::vector<std::uint8_t> filter_seeds(std::span<const Direction> directions,
                                       std::span<const std::uint8_t> seeds, double pixel_rad) {
  Image image(pixel_rad);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (directions[i].range_m > 0) image.add(directions[i], seeds[i] != 0);
  }
  std::vector<std::uint8_t> kept(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (seeds[i] == 0) continue;
    const Count count = image.around(directions[i]);
    kept[i] = 2 * count.seeds >= count.points;
  }
  return kept;
}

std::vector<std::uint8_t> grow(std::vector<std::uint8_t> kept, const GrowthInput& input,
                               const Config& config) {
  std::vector<std::uint32_t> queue;
  std::vector<std::uint8_t> is_left(input.in_range.begin(), input.in_range.end());
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0) continue;
    queue.push_back(i);
    is_left[i] = 0;
  }
  if (queue.empty()) return kept;
  // Each point is looked at once: its residual does not depend on from where it was reached. In a
  // dense cluster nearly every point would else meet all others.
  PointCells left(input.points, is_left, config.growth_distance_m);
  const auto distance_m = static_cast<float>(config.growth_distance_m);
  const auto residual_m = static_cast<float>(config.growth_residual_m);
  std::vector<std::uint32_t> reached;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Eigen::Vector3f& from = input.points[queue[next]];
    reached.clear();
    left.take_around(from, [&](std::uint32_t i) {
      const bool is_near = (input.points[i] - from).squaredNorm() <= distance_m * distance_m;
      if (is_near) reached.push_back(i);
      return is_near;
    });
    for (const std::uint32_t i : reached) {
      const Residual residual =
          residual_of(input.points[i], input.reference, input.reference_cells, config.planar_share);
      if (!(residual.distance_m > residual_m)) continue;
      kept[i] = 1;
      if (input.looks[i].finding != Look::Finding::kUnknown) queue.push_back(i);
    }
  }
  return kept;
}

}  // namespace mosbench::yoon
