#include "core/tsdf/range_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/multiarch.hpp"
#include "core/tsdf/image_lanes.hpp"

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

}  // namespace mosbench::tsdf
