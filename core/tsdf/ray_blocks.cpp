#include "core/tsdf/ray_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace mosbench::tsdf {
namespace {

// As in the authors' program, so that positions on a border belong to the block behind it.
constexpr float kBorder = 1e-6F;

using Steps = std::array<float, 3>;
using Cell = std::array<std::int32_t, 3>;

/// The blocks within reach of the sensor; indices count from the window's corner.
struct Window {
  std::int32_t side;
  std::uint8_t* met;

  std::size_t offset(const Cell& cell) const {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(side) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(side) +
           static_cast<std::size_t>(cell[0]);
  }
};

Cell cell_at(const Steps& position) {
  Cell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<std::int32_t>(std::floor(position[axis] + kBorder));
  }
  return cell;
}

/// Marks the blocks from `start` to `end`, positions in blocks from the window's corner.
void traverse(const Steps& start, const Steps& end, const Window& window) {
  const Cell last = cell_at(end);
  Cell cell = cell_at(start);
  std::int32_t steps = 0;
  Steps to_border{}, per_block{};
  std::array<std::ptrdiff_t, 3> stride{};
  const std::array<std::ptrdiff_t, 3> strides{1, window.side,
                                              std::ptrdiff_t{window.side} * window.side};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float ray = end[axis] - start[axis];
    steps += std::abs(last[axis] - cell[axis]);
    const float sign = ray > 0 ? 1.0F : (ray < 0 ? -1.0F : 0.0F);
    const float inside = start[axis] - static_cast<float>(cell[axis]);
    stride[axis] = strides[axis] * static_cast<std::ptrdiff_t>(sign);
    to_border[axis] = ray == 0 ? 2.0F : (std::max(sign, 0.0F) - inside) / ray;
    per_block[axis] = ray == 0 ? 2.0F : sign / ray;
  }
  std::uint8_t* block = window.met + window.offset(cell);
  *block = 1;
  for (; steps > 0; --steps) {
    std::size_t axis = to_border[1] < to_border[0] ? 1 : 0;
    axis = to_border[2] < to_border[axis] ? 2 : axis;
    to_border[axis] += per_block[axis];
    block += stride[axis];
    *block = 1;
  }
}

}  // namespace

std::size_t RayBlocksScratch::memory_bytes() const {
  std::size_t bytes = 0;
  for (const auto& window : windows) bytes += window.capacity();
  return bytes;
}

std::vector<BlockIndex> ray_blocks(std::span<const Point> points, const ScanPixels& pixels,
                                   const Pose& map_from_sensor, const RayLimits& limits,
                                   RayBlocksScratch& scratch, ThreadPool& pool) {
  const Eigen::Vector3d sensor_blocks =
      (map_from_sensor.translation() - limits.grid_origin_m) / limits.wide_block_m;
  // One block more on each side than a ray can reach, and one for rounding on its way.
  const auto reach = static_cast<std::int32_t>(
      std::ceil((limits.max_range_m + limits.beyond_m) / limits.wide_block_m) + 2);
  const std::int32_t side = 2 * reach + 1;
  Cell corner{};
  Steps sensor{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = sensor_blocks[static_cast<Eigen::Index>(axis)];
    corner[axis] = static_cast<std::int32_t>(std::floor(at)) - reach;
    sensor[axis] = static_cast<float>(at - corner[axis]);
  }
  const Eigen::Matrix3f turned = (map_from_sensor.linear() / limits.wide_block_m).cast<float>();
  const auto min_range_m = static_cast<float>(limits.min_range_m);
  const auto max_range_m = static_cast<float>(limits.max_range_m);
  const auto beyond_m = static_cast<float>(limits.beyond_m);
  const std::size_t cells = static_cast<std::size_t>(side) * static_cast<std::size_t>(side) *
                            static_cast<std::size_t>(side);
  scratch.windows.resize(pool.size());
  for (auto& window : scratch.windows) window.assign(cells, 0);
  pool.for_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end, unsigned thread) {
    const Window window{side, scratch.windows[thread].data()};
    for (std::size_t i = begin; i < end; ++i) {
      const float range_m = pixels.ranges_m[i];
      if (pixels.pixels[i] == kNoPixel || range_m < min_range_m || range_m > max_range_m) continue;
      const Eigen::Vector3f ray = turned * Eigen::Vector3f(points[i].x, points[i].y, points[i].z) *
                                  (1.0F + beyond_m / range_m);
      traverse({sensor[0] + ray.x(), sensor[1] + ray.y(), sensor[2] + ray.z()}, sensor, window);
    }
  });
  std::vector<BlockIndex> blocks;
  std::size_t offset = 0;
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      for (std::int32_t x = 0; x < side; ++x, ++offset) {
        std::uint8_t met = 0;
        for (const auto& window : scratch.windows) met |= window[offset];
        if (met != 0) blocks.push_back({corner[0] + x, corner[1] + y, corner[2] + z});
      }
    }
  }
  return blocks;
}

}  // namespace mosbench::tsdf
