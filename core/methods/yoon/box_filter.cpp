#include "core/methods/yoon/box_filter.hpp"

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

}  // namespace mosbench::yoon
