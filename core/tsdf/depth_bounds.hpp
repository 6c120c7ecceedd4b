#pragma once

#include <cstddef>
#include <vector>

#include "core/tsdf/range_image.hpp"

namespace mosbench::tsdf {

/// Least and greatest depth that an image shows within rectangles, from pyramids of minima and
/// maxima. A place between four empty pixels has depth 0.
class DepthBounds {
 public:
  explicit DepthBounds(const RangeImage& image);

  struct Bounds {
    float least_m, greatest_m;
  };
  /// Returns bounds of depth_at for rows in [first_row, last_row] and columns in [first_column,
  /// last_column], whole numbers: places up to, not including, the next pixel. All must be inside
  /// the image, columns but for the last one.
  Bounds within(int first_row, int last_row, int first_column, int last_column) const;

 private:
  struct Level {
    int rows, columns;
    std::vector<Bounds> bounds;  ///< row by row
  };
  std::vector<Level> levels_;  ///< each half as fine as the one before
};

}  // namespace mosbench::tsdf
