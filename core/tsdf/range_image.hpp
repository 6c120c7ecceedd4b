#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/simd_lanes.hpp"
#include "core/base/thread_pool.hpp"
#include "core/tsdf/sensor_model.hpp"

/// Roots and angles of eight numbers, the same bits on every machine, which those of the C library
/// are not.
/// Places in a range image and depths there, eight at a time.
namespace mosbench::tsdf {

inline __attribute__((always_inline)) FloatLanes sqrt_of(const FloatLanes& lanes) {
#if defined(__SSE2__)
  using Half = float __attribute__((vector_size(16)));
  const Half low = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3);
  const Half high = __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  const auto low_root = static_cast<Half>(_mm_sqrt_ps(low));
  const auto high_root = static_cast<Half>(_mm_sqrt_ps(high));
  return __builtin_shufflevector(low_root, high_root, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  FloatLanes roots{};
  for (std::size_t i = 0; i < kLanes; ++i) roots[i] = std::sqrt(lanes[i]);
  return roots;
#endif
}

/// Returns the angle of (x, y) in turns, -1/2 to 1/2, within 1e-7: the polynomial of Cephes' atanf
/// (Moshier, 1989) after folding into an eighth of a turn. 0 at the origin.
inline __attribute__((always_inline)) FloatLanes angle_turns(const FloatLanes& y,
                                                             const FloatLanes& x) {
  constexpr float kTanOfSixteenth = 0.41421356F;  // of a turn
  constexpr float kTurnsPerRadian = 0.15915494F;
  const FloatLanes ax = magnitude(x), ay = magnitude(y);
  const FloatLanes greater = ax > ay ? ax : ay, less = ax > ay ? ay : ax;
  const IntLanes folds = less > kTanOfSixteenth * greater;
  const FloatLanes above = folds ? less - greater : less;
  const FloatLanes below = folds ? less + greater : greater;
  const FloatLanes t = above / (below > 0.0F ? below : FloatLanes{} + 1.0F);
  const FloatLanes z = t * t;
  const FloatLanes radians =
      (((8.05374449538e-2F * z - 1.38776856032e-1F) * z + 1.99777106478e-1F) * z -
       3.33329491539e-1F) *
          z * t +
      t;
  const FloatLanes octant =
      radians * kTurnsPerRadian + (folds ? FloatLanes{} + 0.125F : FloatLanes{});
  const FloatLanes quadrant = ay > ax ? 0.25F - octant : octant;
  const FloatLanes half = x < 0.0F ? 0.5F - quadrant : quadrant;
  return y < 0.0F ? -half : half;
}

/// Turns directions into places, as place_in_image does.
struct ImageProjection {
  explicit ImageProjection(const SensorModel& sensor);

  struct Place {
    FloatLanes row, column;
  };
  /// `flat` is the length of (x, y).
  inline __attribute__((always_inline)) Place place(const FloatLanes& x, const FloatLanes& y,
                                                    const FloatLanes& z,
                                                    const FloatLanes& flat) const {
    const FloatLanes row = (up_turns - angle_turns(z, flat)) * rows_per_turn;
    const FloatLanes phi = angle_turns(-y, x) - first_turns;
    return {row, (phi < 0.0F ? phi + 1.0F : phi) * columns};
  }

  float up_turns, rows_per_turn, first_turns;
  float columns;                ///< H
  float last_row, last_column;  ///< V - 1, H - 1
};

/// The four pixels around eight places.
struct FourPixels {
  FloatLanes top_left, top_right, bottom_left, bottom_right;
};

/// Returns the depths, as depth_at does. Shares are those of the lower row and the right column.
inline __attribute__((always_inline)) FloatLanes depth_between(const FourPixels& p,
                                                               const FloatLanes& row_share,
                                                               const FloatLanes& column_share,
                                                               float half_truncation_m) {
  const auto column = [&](const FloatLanes& top, const FloatLanes& bottom, FloatLanes& least) {
    const FloatLanes less = top < bottom ? top : bottom;
    const FloatLanes between = (1.0F - row_share) * top + row_share * bottom;
    least = top == 0.0F ? bottom : (bottom == 0.0F ? top : less);
    return top == 0.0F ? bottom : (bottom == 0.0F ? top : between);
  };
  FloatLanes left_least, right_least;
  const FloatLanes left = column(p.top_left, p.bottom_left, left_least);
  const FloatLanes right = column(p.top_right, p.bottom_right, right_least);
  const FloatLanes between = (1.0F - column_share) * left + column_share * right;
  const FloatLanes depth = left == 0.0F ? right : (right == 0.0F ? left : between);
  const FloatLanes less = left_least < right_least ? left_least : right_least;
  const FloatLanes least =
      left_least == 0.0F ? right_least : (right_least == 0.0F ? left_least : less);
  return least + half_truncation_m < depth ? least : depth;
}

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
