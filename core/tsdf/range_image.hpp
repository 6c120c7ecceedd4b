#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/tsdf/sensor_model.hpp"

namespace mosbench::tsdf {

/// Ranges of the nearest returns by direction, metres; 0 where there is none, and below min_range.
struct RangeImage {
  int rows = 0, columns = 0;
  std::vector<float> ranges_m;  ///< row by row, with an empty row below the last one

  float at(int row, int column) const {
    return ranges_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
  }
};

inline constexpr std::int32_t kNoPixel = -1;

/// The pixels of a scan's points.
struct ScanPixels {
  std::vector<std::int32_t> pixels;  ///< row * H + column, or kNoPixel
  std::vector<float> ranges_m;
};

/// Row and column truncated toward zero, so that directions up to a row above the field of view
/// fall into the first row; rejected are then rows beyond the last, and columns 0 and H - 1. Points
/// that are not finite, and those nearer than 1e-6 m, have no pixel.
ScanPixels pixels_of(std::span<const Point> points, const SensorModel& sensor, ThreadPool& pool);

/// Keeps the smallest range per pixel; those below min_range_m hide what is behind them and count
/// as empty.
RangeImage range_image(const ScanPixels& pixels, const SensorModel& sensor, float min_range_m);

/// A place in the image, between pixels.
struct ImagePlace {
  float row, column;
};
/// Returns where a direction lies: h = (V - 1) (up - elevation) / field, w = H phi / 2 pi with phi
/// = -atan2(y, x) - first in [0, 2 pi).
ImagePlace place_in_image(const SensorModel& sensor, const Point& direction);

/// Returns the depth at a place between pixels, "adaptive": linear between the pixels around that
/// are not empty, or their minimum if that is nearer by more than half of the truncation distance.
/// 0 if all four are empty.
float depth_at(const RangeImage& image, const ImagePlace& place, float half_truncation_m);

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
