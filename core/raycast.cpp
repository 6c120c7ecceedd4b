#include "core/raycast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace mosbench {

struct RaycastScratch::Ray {
  std::int32_t dx, dy, dz;  ///< measured voxel - sensor voxel
  std::int32_t visits;      ///< voxels within range, from the sensor's own
};

/// Bits of a box of voxels around the sensor, a byte for eight voxels along x, in tiles of 4x4x4
/// blocks (one page each). The byte address of a voxel is the sum of three table entries, one per
/// axis.
struct RaycastScratch::Window {
  static constexpr int kTileSide = 32;
  static constexpr std::size_t kTileBytes = 4096;

  std::array<std::vector<std::uint32_t>, 3> offsets;
  std::vector<std::uint8_t> x_bits;
  std::array<std::size_t, 3> tiles{};
  std::size_t capacity_tiles = 0;
  struct Free {
    void operator()(std::uint8_t* pointer) const { std::free(pointer); }
  };
  std::unique_ptr<std::uint8_t, Free> bits;  ///< all zero between calls
  std::vector<std::uint8_t> tile_touched;
  std::vector<std::uint32_t> touched_tiles;

  void lay_out(const std::array<std::size_t, 3>& tiles_per_axis);
  void touch(std::uint32_t tile) {
    if (tile_touched[tile] != 0) return;
    tile_touched[tile] = 1;
    touched_tiles.push_back(tile);
  }
};

RaycastScratch::RaycastScratch() = default;
RaycastScratch::~RaycastScratch() = default;
RaycastScratch::RaycastScratch(RaycastScratch&&) noexcept = default;
RaycastScratch& RaycastScratch::operator=(RaycastScratch&&) noexcept = default;

void RaycastScratch::Window::lay_out(const std::array<std::size_t, 3>& tiles_per_axis) {
  const std::size_t count = tiles_per_axis[0] * tiles_per_axis[1] * tiles_per_axis[2];
  if (count > capacity_tiles) {
    bits.reset();
    capacity_tiles = count + count / 4;
    // calloc, not vector: pages that no ray touches must stay unmapped.
    bits.reset(static_cast<std::uint8_t*>(std::calloc(capacity_tiles, kTileBytes)));
    if (!bits) throw std::bad_alloc();
  }
  tile_touched.assign(count, 0);
  touched_tiles.clear();
  if (tiles == tiles_per_axis) return;
  tiles = tiles_per_axis;
  // Bytes per step of (voxel in block, block in tile, tile), x fastest.
  const std::array<std::array<std::size_t, 3>, 3> strides{
      {{0, 64, kTileBytes},
       {1, 256, kTileBytes * tiles[0]},
       {8, 1024, kTileBytes * tiles[0] * tiles[1]}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    offsets[axis].clear();
    for (std::size_t c = 0; c < tiles[axis] * kTileSide; ++c) {
      offsets[axis].push_back(static_cast<std::uint32_t>(
          c % 8 * strides[axis][0] + c / 8 % 4 * strides[axis][1] + c / 32 * strides[axis][2]));
    }
  }
  x_bits.clear();
  for (std::size_t c = 0; c < tiles[0] * kTileSide; ++c) {
    x_bits.push_back(static_cast<std::uint8_t>(1u << (c % 8)));
  }
}

namespace {

using Ray = RaycastScratch::Ray;
using Window = RaycastScratch::Window;

/// The line in closed form. With M the longest side and h = M / 2, an axis has moved
/// floor((i d + M - 1 - h) / M) times after i steps: the authors' error terms unrolled. The
/// quotient is taken in fixed point with a reciprocal rounded up, exact while (i + 1) M^2 <
/// 2^kFraction.
constexpr int kFraction = 50;

std::int64_t reciprocal(std::int32_t longest) {
  return (std::int64_t{1} << kFraction) / longest + 1;
}

std::int32_t longest_side(const Ray& ray) {
  return std::max({std::abs(ray.dx), std::abs(ray.dy), std::abs(ray.dz)});
}

struct Line {
  std::int64_t reciprocal, start;
  std::int32_t moves(std::int32_t distance, std::int32_t step) const {
    const std::int64_t numerator = std::int64_t{step} * std::abs(distance);
    const auto moved = static_cast<std::int32_t>((numerator * reciprocal + start) >> kFraction);
    return distance < 0 ? -moved : moved;
  }
};

Line line_of(std::int32_t longest) {
  const std::int64_t r = reciprocal(longest);
  return {r, (longest - 1 - longest / 2) * r};
}

double distance_sq_m2(std::int32_t dx, std::int32_t dy, std::int32_t dz, double voxel_size_m) {
  const double x = dx * voxel_size_m, y = dy * voxel_size_m, z = dz * voxel_size_m;
  return (x * x + y * y) + z * z;
}

/// Number of voxels within range on the line to a voxel beyond it. The distance never falls
/// along a line, so a guess from the ratio of lengths is corrected step by step.
std::int32_t visits_within_range(const Ray& ray, double range_sq_m2, double voxel_size_m) {
  const std::int32_t longest = longest_side(ray);
  const Line line = line_of(longest);
  const auto inside = [&](std::int32_t step) {
    return distance_sq_m2(line.moves(ray.dx, step), line.moves(ray.dy, step),
                          line.moves(ray.dz, step), voxel_size_m) <= range_sq_m2;
  };
  const double full_sq_m2 = distance_sq_m2(ray.dx, ray.dy, ray.dz, voxel_size_m);
  auto step = static_cast<std::int32_t>(longest * std::sqrt(range_sq_m2 / full_sq_m2));
  step = std::min(step, longest);
  while (step > 0 && !inside(step)) --step;
  while (step < longest && inside(step + 1)) ++step;
  return step + 1;
}

struct Bounds {
  std::array<std::int32_t, 3> low{0, 0, 0}, high{0, 0, 0};  ///< relative to the sensor's voxel
  void include(std::int32_t dx, std::int32_t dy, std::int32_t dz) {
    const std::array<std::int32_t, 3> d{dx, dy, dz};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], d[axis]);
      high[axis] = std::max(high[axis], d[axis]);
    }
  }
};

/// One ray per measured voxel; grows `bounds` around every voxel that will be visited.
void collect_rays(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                  double max_range_m, std::vector<Ray>& rays, Bounds& bounds) {
  const double range_sq_m2 = max_range_m * max_range_m;
  rays.clear();
  for (std::size_t slot = 0; slot < measured.block_count(); ++slot) {
    const Voxel corner = voxel_at(measured.blocks[slot], 0);
    for_each_cell(measured.masks[slot], [&](std::uint32_t cell) {
      Ray ray{corner.x + static_cast<std::int32_t>(cell & 7) - sensor.x,
              corner.y + static_cast<std::int32_t>((cell >> 3) & 7) - sensor.y,
              corner.z + static_cast<std::int32_t>(cell >> 6) - sensor.z, 0};
      const std::int32_t longest = longest_side(ray);
      if (distance_sq_m2(ray.dx, ray.dy, ray.dz, voxel_size_m) <= range_sq_m2) {
        ray.visits = longest + 1;
        bounds.include(ray.dx, ray.dy, ray.dz);
      } else {
        ray.visits = visits_within_range(ray, range_sq_m2, voxel_size_m);
        const Line line = line_of(longest);
        bounds.include(line.moves(ray.dx, ray.visits - 1), line.moves(ray.dy, ray.visits - 1),
                       line.moves(ray.dz, ray.visits - 1));
      }
      rays.push_back(ray);
    });
  }
}

/// A point that walks a line: per axis the coordinate in the window, as fixed point.
struct Walk {
  std::array<std::int64_t, 3> at, step;

  Walk(const Ray& ray, const std::array<std::int32_t, 3>& sensor) {
    const std::int32_t longest = std::max(longest_side(ray), 1);
    const Line line = line_of(longest);
    const std::array<std::int32_t, 3> d{ray.dx, ray.dy, ray.dz};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t forward = std::int64_t{sensor[axis]} << kFraction;
      const std::int64_t speed = std::abs(d[axis]) * line.reciprocal;
      // s - floor(a) is floor(s + 1 - a) less the smallest unit.
      at[axis] = d[axis] < 0 ? forward + (std::int64_t{1} << kFraction) - 1 - line.start
                             : forward + line.start;
      step[axis] = d[axis] < 0 ? -speed : speed;
    }
  }
};

void touch_tiles(const Ray& ray, const Walk& walk, Window& window) {
  constexpr std::int32_t kStride = 16;
  std::array<std::size_t, 3> previous{};
  for (std::int32_t i = 0;; i = std::min(i + kStride, ray.visits - 1)) {
    std::array<std::size_t, 3> tile{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      tile[axis] =
          static_cast<std::size_t>((walk.at[axis] + i * walk.step[axis]) >> (kFraction + 5));
    }
    if (i == 0) previous = tile;
    // Between two samples a line may cross any tile of the box that they span.
    for (std::size_t z = std::min(tile[2], previous[2]); z <= std::max(tile[2], previous[2]); ++z) {
      for (std::size_t y = std::min(tile[1], previous[1]); y <= std::max(tile[1], previous[1]);
           ++y) {
        for (std::size_t x = std::min(tile[0], previous[0]); x <= std::max(tile[0], previous[0]);
             ++x) {
          window.touch(static_cast<std::uint32_t>((z * window.tiles[1] + y) * window.tiles[0] + x));
        }
      }
    }
    if (i == ray.visits - 1) return;
    previous = tile;
  }
}

void cast(const Ray& ray, const std::array<std::int32_t, 3>& sensor, Window& window) {
  Walk walk(ray, sensor);
  touch_tiles(ray, walk, window);
  const std::uint32_t* x_offsets = window.offsets[0].data();
  const std::uint32_t* y_offsets = window.offsets[1].data();
  const std::uint32_t* z_offsets = window.offsets[2].data();
  const std::uint8_t* x_bits = window.x_bits.data();
  std::uint8_t* bits = window.bits.get();
  std::int64_t x = walk.at[0], y = walk.at[1], z = walk.at[2];
  for (std::int32_t i = 0; i < ray.visits; ++i) {
    const auto column = static_cast<std::size_t>(x >> kFraction);
    const std::size_t address = std::size_t{x_offsets[column]} +
                                y_offsets[static_cast<std::size_t>(y >> kFraction)] +
                                z_offsets[static_cast<std::size_t>(z >> kFraction)];
    bits[address] |= x_bits[column];
    x += walk.step[0];
    y += walk.step[1];
    z += walk.step[2];
  }
}

}  // namespace

ObservedVoxels raycast(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                       double max_range_m, RaycastScratch& scratch, ThreadPool& pool) {
  Bounds bounds;
  collect_rays(measured, sensor, voxel_size_m, max_range_m, scratch.rays, bounds);

  // The window starts at a tile corner of its own, aligned to blocks.
  const std::array<std::int32_t, 3> s{sensor.x, sensor.y, sensor.z};
  std::array<std::int32_t, 3> first_block{}, sensor_in_window{};
  std::array<std::size_t, 3> tiles{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_block[axis] = (s[axis] + bounds.low[axis]) >> 3;
    sensor_in_window[axis] = s[axis] - first_block[axis] * kBlockSide;
    tiles[axis] =
        static_cast<std::size_t>(sensor_in_window[axis] + bounds.high[axis]) / Window::kTileSide +
        1;
  }
  if (scratch.windows.size() < pool.size()) scratch.windows.resize(pool.size());
  for (unsigned thread = 0; thread < pool.size(); ++thread) scratch.windows[thread].lay_out(tiles);

  pool.for_ranges(scratch.rays.size(), 1024,
                  [&](std::size_t begin, std::size_t end, unsigned thread) {
                    Window& window = scratch.windows[thread];
                    for (std::size_t i = begin; i < end; ++i)
                      cast(scratch.rays[i], sensor_in_window, window);
                  });

  // Unite the windows and leave them zero.
  Window& all = scratch.windows.front();
  for (unsigned thread = 1; thread < pool.size(); ++thread) {
    for (const std::uint32_t tile : scratch.windows[thread].touched_tiles) all.touch(tile);
  }
  ObservedVoxels observed;
  for (const std::uint32_t tile : all.touched_tiles) {
    const std::size_t tile_x = tile % tiles[0], tile_y = tile / tiles[0] % tiles[1],
                      tile_z = tile / tiles[0] / tiles[1];
    for (std::size_t block = 0; block < 64; ++block) {
      BlockMask mask;
      for (unsigned thread = 0; thread < pool.size(); ++thread) {
        Window& window = scratch.windows[thread];
        if (window.tile_touched[tile] == 0) continue;
        std::uint8_t* bytes = window.bits.get() + tile * Window::kTileBytes + block * 64;
        BlockMask part;
        std::copy_n(bytes, 64, reinterpret_cast<std::uint8_t*>(part.words.data()));
        mask = mask | part;
        std::fill_n(bytes, 64, std::uint8_t{0});
      }
      if (!mask.any()) continue;
      observed.blocks.push_back(
          {first_block[0] + static_cast<std::int32_t>(tile_x * 4 + block % 4),
           first_block[1] + static_cast<std::int32_t>(tile_y * 4 + block / 4 % 4),
           first_block[2] + static_cast<std::int32_t>(tile_z * 4 + block / 16)});
      observed.masks.push_back(mask);
    }
  }
  return observed;
}

}  // namespace mosbench
