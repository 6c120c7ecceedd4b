#include "core/tsdf/range_image.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "core/base/multiarch.hpp"

namespace mosbench::tsdf {
namespace {

constexpr float kShortestRange_m = 1e-6F;

struct EightPoints {
  std::array<float, kLanes> x{}, y{}, z{};
};

/// Writes pixels and ranges of eight points.
inline __attribute__((always_inline)) void place_eight(const EightPoints& points,
                                                       const ImageProjection& projection,
                                                       std::int32_t* pixels, float* ranges_m) {
  const auto x = load<FloatLanes>(points.x.data()), y = load<FloatLanes>(points.y.data()),
             z = load<FloatLanes>(points.z.data());
  const FloatLanes flat_sq = x * x + y * y;
  const FloatLanes range_m = sqrt_of(flat_sq + z * z);
  const ImageProjection::Place at = projection.place(x, y, z, sqrt_of(flat_sq));
  // Where coordinates are not finite, no comparison holds.
  const IntLanes inside = (range_m > kShortestRange_m) & (range_m - range_m == 0.0F) &
                          (at.row > -1.0F) & (at.row < projection.last_row + 1.0F) &
                          (at.column >= 1.0F) & (at.column < projection.last_column);
  const IntLanes row = __builtin_convertvector(inside ? at.row : FloatLanes{}, IntLanes);
  const IntLanes column = __builtin_convertvector(inside ? at.column : FloatLanes{}, IntLanes);
  const IntLanes pixel = row * static_cast<std::int32_t>(projection.columns) + column;
  store(inside ? pixel : IntLanes{} + kNoPixel, pixels);
  store(range_m, ranges_m);
}

MOSBENCH_MULTIARCH void place_all(std::span<const Point> points, const ImageProjection& projection,
                                  std::int32_t* pixels, float* ranges_m) {
  const std::size_t whole = points.size() / kLanes * kLanes;
  EightPoints eight;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t j = 0; j < kLanes; ++j) {
      eight.x[j] = points[i + j].x;
      eight.y[j] = points[i + j].y;
      eight.z[j] = points[i + j].z;
    }
    place_eight(eight, projection, pixels + i, ranges_m + i);
  }
  if (whole == points.size()) return;
  eight = {};
  for (std::size_t j = 0; whole + j < points.size(); ++j) {
    eight.x[j] = points[whole + j].x;
    eight.y[j] = points[whole + j].y;
    eight.z[j] = points[whole + j].z;
  }
  std::array<std::int32_t, kLanes> last_pixels{};
  std::array<float, kLanes> last_ranges_m{};
  place_eight(eight, projection, last_pixels.data(), last_ranges_m.data());
  const auto rest = static_cast<std::ptrdiff_t>(points.size() - whole);
  std::copy_n(last_pixels.begin(), rest, pixels + whole);
  std::copy_n(last_ranges_m.begin(), rest, ranges_m + whole);
}

// Rectangles are at most so many cells wide and high on the level that is asked.
constexpr int kCellsAcross = 4;
constexpr int kLevels = 7;

using Bounds = DepthBounds::Bounds;

Bounds united(const Bounds& a, const Bounds& b) {
  return {std::min(a.least_m, b.least_m), std::max(a.greatest_m, b.greatest_m)};
}

}  // namespace

ImageProjection::ImageProjection(const SensorModel& sensor)
    : up_turns(static_cast<float>(sensor.up_deg / 360)),
      rows_per_turn(
          static_cast<float>((sensor.rows - 1) * 360 / (sensor.up_deg - sensor.down_deg))),
      first_turns(static_cast<float>(sensor.first_deg / 360)),
      columns(static_cast<float>(sensor.columns)),
      last_row(static_cast<float>(sensor.rows - 1)),
      last_column(static_cast<float>(sensor.columns - 1)) {}

ScanPixels pixels_of(std::span<const Point> points, const SensorModel& sensor, ThreadPool& pool) {
  ScanPixels result;
  result.pixels.resize(points.size());
  result.ranges_m.resize(points.size());
  const ImageProjection projection(sensor);
  pool.for_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end, unsigned) {
    place_all(points.subspan(begin, end - begin), projection, &result.pixels[begin],
              &result.ranges_m[begin]);
  });
  return result;
}

RangeImage range_image(const ScanPixels& pixels, const SensorModel& sensor, float min_range_m) {
  RangeImage image{.rows = sensor.rows, .columns = sensor.columns, .ranges_m = {}};
  image.ranges_m.resize(static_cast<std::size_t>(sensor.rows + 1) *
                        static_cast<std::size_t>(sensor.columns));
  for (std::size_t i = 0; i < pixels.pixels.size(); ++i) {
    if (pixels.pixels[i] == kNoPixel) continue;
    float& range_m = image.ranges_m[static_cast<std::size_t>(pixels.pixels[i])];
    if (range_m == 0 || pixels.ranges_m[i] < range_m) range_m = pixels.ranges_m[i];
  }
  for (float& range_m : image.ranges_m) {
    if (range_m < min_range_m) range_m = 0;
  }
  return image;
}

ImagePlace place_in_image(const SensorModel& sensor, const Point& direction) {
  const FloatLanes x = FloatLanes{} + direction.x, y = FloatLanes{} + direction.y;
  const ImageProjection::Place place =
      ImageProjection(sensor).place(x, y, FloatLanes{} + direction.z, sqrt_of(x * x + y * y));
  return {place.row[0], place.column[0]};
}

float depth_at(const RangeImage& image, const ImagePlace& place, float half_truncation_m) {
  const int h = static_cast<int>(place.row), w = static_cast<int>(place.column);
  const auto pixel = [&](int down, int right) {
    return FloatLanes{} + image.at(h + down, w + right);
  };
  const FloatLanes depth =
      depth_between({pixel(0, 0), pixel(0, 1), pixel(1, 0), pixel(1, 1)},
                    FloatLanes{} + (place.row - static_cast<float>(h)),
                    FloatLanes{} + (place.column - static_cast<float>(w)), half_truncation_m);
  return depth[0];
}

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
