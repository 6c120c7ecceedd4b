#include "core/tsdf/tsdf_map.hpp"

#include <bit>
#include <cmath>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

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
};

/// Positions of eight rays' starts, in blocks from the window's corner.
using Starts = std::array<LaneArray, 3>;

inline __attribute__((always_inline)) IntLanes index_of(const FloatLanes& position) {
  const FloatLanes behind_border = position + kBorder;
  const IntLanes truncated = __builtin_convertvector(behind_border, IntLanes);
  return truncated + (__builtin_convertvector(truncated, FloatLanes) > behind_border);  // -1: true
}

/// Marks the blocks from eight starts to `end`.
MOSBENCH_MULTIARCH void traverse(const Starts& starts, const Steps& end, const Window& window) {
  // A local: the byte stores below could otherwise change anything behind a reference.
  std::uint8_t* const met = window.met;
  const std::array<std::int32_t, 3> strides{1, window.side, window.side * window.side};
  IntLanes offset{}, steps{}, stride[3];
  FloatLanes to_border[3], per_block[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto start = load<FloatLanes>(starts[axis].data());
    const FloatLanes ray = end[axis] - start;
    const IntLanes cell = index_of(start), last = index_of(FloatLanes{} + end[axis]);
    const FloatLanes inside = start - __builtin_convertvector(cell, FloatLanes);
    const FloatLanes one = FloatLanes{} + 1.0F, two = FloatLanes{} + 2.0F, none{};
    const FloatLanes ahead = ray > 0.0F ? one : none;
    const FloatLanes sign = ray < 0.0F ? -one : ahead;
    to_border[axis] = ray == 0.0F ? two : (ahead - inside) / ray;
    per_block[axis] = ray == 0.0F ? two : sign / ray;
    steps += magnitude(last - cell);
    offset += cell * strides[axis];
    stride[axis] = __builtin_convertvector(sign, IntLanes) * strides[axis];
  }
  for (;; steps -= 1) {
    LaneArray offsets;
    store(offset, offsets);
    for (const std::uint32_t at : offsets) met[at] = 1;
    const IntLanes goes_on = steps > 0;
    if (bits_of(goes_on) == 0) return;
    const IntLanes y_first = to_border[1] < to_border[0];
    const IntLanes z_first = to_border[2] < (y_first ? to_border[1] : to_border[0]);
    const IntLanes along[3] = {goes_on & ~y_first & ~z_first, goes_on & y_first & ~z_first,
                               goes_on & z_first};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      to_border[axis] = along[axis] ? to_border[axis] + per_block[axis] : to_border[axis];
      offset += along[axis] & stride[axis];
    }
  }
}

/// Collects rays until there are eight to be walked together.
class RayBatch {
 public:
  RayBatch(const Steps& end, const Window& window) : end_(end), window_(window) {}

  void add(const Steps& start) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      starts_[axis][count_] = std::bit_cast<std::uint32_t>(start[axis]);
    }
    if (++count_ == kLanes) finish();
  }
  void finish() {
    if (count_ == 0) return;
    for (std::size_t lane = count_; lane < kLanes; ++lane) {
      for (LaneArray& starts : starts_) starts[lane] = starts[0];  // the first ray once more
    }
    traverse(starts_, end_, window_);
    count_ = 0;
  }

 private:
  const Steps& end_;
  const Window& window_;
  Starts starts_;
  std::size_t count_ = 0;
};

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
    RayBatch rays(sensor, window);
    for (std::size_t i = begin; i < end; ++i) {
      const float range_m = pixels.ranges_m[i];
      if (pixels.pixels[i] == kNoPixel || range_m < min_range_m || range_m > max_range_m) continue;
      const Eigen::Vector3f ray = turned * Eigen::Vector3f(points[i].x, points[i].y, points[i].z) *
                                  (1.0F + beyond_m / range_m);
      rays.add({sensor[0] + ray.x(), sensor[1] + ray.y(), sensor[2] + ray.z()});
    }
    rays.finish();
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

TsdfMap::Touched TsdfMap::touch(const std::vector<BlockIndex>& wide_blocks) {
  Touched touched;
  touched.slots.reserve(wide_blocks.size() * 8);
  for (const BlockIndex& wide : wide_blocks) {
    const BlockIndex first = first_in(wide);
    for (int part = 0; part < 8; ++part) {
      const auto [slot, fresh] = blocks.find_or_add(
          {first.x + (part & 1), first.y + (part >> 1 & 1), first.z + (part >> 2)});
      if (fresh) {
        blocks[slot] = MapBlock{};
        blocks[slot].near_surface = ~BlockMask{};
        touched.fresh.push_back(slot);
      }
      touched.slots.push_back(slot);
    }
  }
  return touched;
}

void TsdfMap::add_numbers(MapBlock& block) {
  block.numbers = numbers.take();
  VoxelNumbers& all = numbers[block.numbers];
  all.distances_m.fill(0);
  all.weights.fill(0);
}

std::vector<std::uint32_t> TsdfMap::keep_near(const Eigen::Vector3d& sensor_m,
                                              const VoxelGrid& grid, const Config& config) {
  std::vector<std::uint32_t> removed;
  const double wide_block_m = kWideSide * config.voxel_size_m;
  if (kept_around_m_ && (*kept_around_m_ - sensor_m).norm() < wide_block_m) return removed;
  kept_around_m_ = sensor_m;
  // Blocks of this scan end no farther than this beyond the range.
  const double beyond_m = config.truncation_m() + 2 * wide_block_m;
  const double radius_m = config.map_radius_ranges * config.max_range_m + beyond_m;
  blocks.for_each_slot([&](std::uint32_t slot) {
    const BlockIndex wide = wide_of(blocks.index_of(slot));
    const Eigen::Vector3d centre_m =
        grid.corner_m({wide.x * kWideSide + kWideSide / 2, wide.y * kWideSide + kWideSide / 2,
                       wide.z * kWideSide + kWideSide / 2});
    if ((centre_m - sensor_m).squaredNorm() <= radius_m * radius_m) return;
    if (blocks[slot].numbers != kNoSlot) numbers.give_back(blocks[slot].numbers);
    blocks.erase(slot);
    removed.push_back(slot);
  });
  return removed;
}

}  // namespace mosbench::tsdf
