#include "core/tsdf/depth_bounds.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace mosbench::tsdf {
namespace {

// Rectangles are at most so many cells wide and high on the level that is asked.
constexpr int kCellsAcross = 4;
constexpr int kLevels = 7;

using Bounds = DepthBounds::Bounds;

Bounds united(const Bounds& a, const Bounds& b) {
  return {std::min(a.least_m, b.least_m), std::max(a.greatest_m, b.greatest_m)};
}

}  // namespace

DepthBounds::DepthBounds(const RangeImage& image) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  Level finest{image.rows, image.columns - 1, {}};
  finest.bounds.reserve(static_cast<std::size_t>(finest.rows) *
                        static_cast<std::size_t>(finest.columns));
  for (int row = 0; row < finest.rows; ++row) {
    const float* top =
        &image.ranges_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns)];
    const float* bottom = top + image.columns;
    for (int column = 0; column < finest.columns; ++column) {
      const auto present = [&](float range_m) { return range_m == 0 ? kNone : range_m; };
      const float least = std::min(std::min(present(top[column]), present(top[column + 1])),
                                   std::min(present(bottom[column]), present(bottom[column + 1])));
      const float greatest = std::max(std::max(top[column], top[column + 1]),
                                      std::max(bottom[column], bottom[column + 1]));
      finest.bounds.push_back({least == kNone ? 0 : least, greatest});
    }
  }
  levels_.push_back(std::move(finest));
  while (levels_.size() < kLevels) {
    const Level& fine = levels_.back();
    Level coarse{(fine.rows + 1) / 2, (fine.columns + 1) / 2, {}};
    coarse.bounds.reserve(static_cast<std::size_t>(coarse.rows) *
                          static_cast<std::size_t>(coarse.columns));
    const auto at = [&](int row, int column) -> const Bounds& {
      return fine.bounds[static_cast<std::size_t>(std::min(row, fine.rows - 1)) *
                             static_cast<std::size_t>(fine.columns) +
                         static_cast<std::size_t>(std::min(column, fine.columns - 1))];
    };
    for (int row = 0; row < coarse.rows; ++row) {
      for (int column = 0; column < coarse.columns; ++column) {
        coarse.bounds.push_back(
            united(united(at(2 * row, 2 * column), at(2 * row, 2 * column + 1)),
                   united(at(2 * row + 1, 2 * column), at(2 * row + 1, 2 * column + 1))));
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

DepthBounds::Bounds DepthBounds::within(int first_row, int last_row, int first_column,
                                        int last_column) const {
  const int longest = std::max(last_row - first_row, last_column - first_column);
  const auto wanted =
      static_cast<int>(std::bit_width(static_cast<unsigned>(longest / kCellsAcross)));
  const int shift = std::min(wanted, kLevels - 1);
  const Level& level = levels_[static_cast<std::size_t>(shift)];
  Bounds bounds{std::numeric_limits<float>::infinity(), 0};
  for (int row = first_row >> shift; row <= last_row >> shift; ++row) {
    for (int column = first_column >> shift; column <= last_column >> shift; ++column) {
      bounds = united(
          bounds,
          level.bounds[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.columns) +
                       static_cast<std::size_t>(column)]);
    }
  }
  return bounds;
}

}  // namespace mosbench::tsdf
