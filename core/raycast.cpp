#include "core/raycast.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <numeric>
#include <span>

#include "core/lanes.hpp"
#include "core/multiarch.hpp"

namespace mosbench {

struct RaycastScratch::Ray {
  std::int32_t dx, dy, dz;  ///< measured voxel - sensor voxel
  std::int32_t visits;      ///< voxels within range, from the sensor's own
};

/// Bits of a box of voxels around the sensor, a byte for eight voxels along x, in tiles of 4x4x4
/// blocks (one page each). Numbers of tiles are powers of two, so that an address is put together
/// by shifting coordinates.
struct RaycastScratch::Window {
  static constexpr std::uint32_t kTileSide = 32;
  static constexpr std::uint32_t kTileBytes = 4096;

  std::array<int, 3> log2_tiles{};  ///< along x, y, z
  std::size_t capacity_tiles = 0;
  struct Free {
    void operator()(std::uint8_t* pointer) const { std::free(pointer); }
  };
  std::unique_ptr<std::uint8_t, Free> bits;  ///< all zero between calls
  std::vector<std::uint8_t> tile_touched;    ///< in this call
  std::vector<std::uint32_t> touched_tiles;
  std::vector<std::uint8_t> tile_resident;  ///< in any call

  void lay_out(const std::array<int, 3>& log2_tiles_per_axis);
  int y_shift() const { return 12 + log2_tiles[0]; }
  int z_shift() const { return y_shift() + log2_tiles[1]; }
  void touch(std::uint32_t tile) {
    if (tile_touched[tile] != 0) return;
    tile_touched[tile] = tile_resident[tile] = 1;
    touched_tiles.push_back(tile);
  }
  /// Touches every tile that a line may have crossed between two that lie at most one apart per
  /// axis.
  void touch_between(std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    touch(b);
    const std::uint32_t x = (1u << log2_tiles[0]) - 1;
    const std::uint32_t y = (1u << (log2_tiles[0] + log2_tiles[1])) - 1 - x;
    const std::uint32_t changed = a ^ b;
    const int axes = ((changed & x) != 0) + ((changed & y) != 0) + ((changed & ~(x | y)) != 0);
    if (axes == 1) return;
    for (const std::uint32_t of_b : {x, y, x | y, ~(x | y), ~y, ~x}) {
      touch((a & ~of_b) | (b & of_b));
    }
  }
};

RaycastScratch::RaycastScratch() = default;
RaycastScratch::~RaycastScratch() = default;
RaycastScratch::RaycastScratch(RaycastScratch&&) noexcept = default;
RaycastScratch& RaycastScratch::operator=(RaycastScratch&&) noexcept = default;

std::size_t RaycastScratch::steps() const {
  return std::accumulate(
      rays.begin(), rays.end(), std::size_t{0},
      [](std::size_t sum, const Ray& ray) { return sum + static_cast<std::size_t>(ray.visits); });
}

std::size_t RaycastScratch::memory_bytes() const {
  std::size_t bytes = (rays.capacity() + sorted_rays.capacity()) * sizeof(Ray);
  for (const Window& window : windows) {
    const auto resident =
        std::count(window.tile_resident.begin(), window.tile_resident.end(), std::uint8_t{1});
    bytes += static_cast<std::size_t>(resident) * Window::kTileBytes + 2 * window.capacity_tiles;
  }
  return bytes;
}

void RaycastScratch::Window::lay_out(const std::array<int, 3>& log2_tiles_per_axis) {
  log2_tiles = log2_tiles_per_axis;
  const std::size_t count = std::size_t{1} << (log2_tiles[0] + log2_tiles[1] + log2_tiles[2]);
  if (count > capacity_tiles) {
    bits.reset();
    capacity_tiles = count;
    // calloc, not vector: pages that no ray touches must stay unmapped.
    bits.reset(static_cast<std::uint8_t*>(std::calloc(capacity_tiles, kTileBytes)));
    if (!bits) throw std::bad_alloc();
    tile_resident.assign(capacity_tiles, 0);
  }
  tile_touched.assign(count, 0);
  touched_tiles.clear();
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

/// A box around every voxel that will be visited, relative to the sensor's voxel.
struct Bounds {
  std::array<std::int32_t, 3> low{0, 0, 0}, high{0, 0, 0};

  /// A block of measured voxels; rays end `reach` voxels from the sensor.
  void include(const std::array<std::int32_t, 3>& corner, std::int32_t reach) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], std::max(corner[axis], -reach));
      high[axis] = std::max(high[axis], std::min(corner[axis] + kBlockSide - 1, reach));
    }
  }
};

/// One ray per measured voxel.
void collect_rays(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                  double max_range_m, std::vector<Ray>& rays, Bounds& bounds) {
  const double range_sq_m2 = max_range_m * max_range_m;
  const auto reach = static_cast<std::int32_t>(std::ceil(max_range_m / voxel_size_m)) + 1;
  rays.clear();
  for (std::size_t slot = 0; slot < measured.block_count(); ++slot) {
    const Voxel first = voxel_at(measured.blocks[slot], 0);
    const std::array<std::int32_t, 3> corner{first.x - sensor.x, first.y - sensor.y,
                                             first.z - sensor.z};
    bounds.include(corner, reach);
    for_each_cell(measured.masks[slot], [&](std::uint32_t cell) {
      Ray ray{corner[0] + static_cast<std::int32_t>(cell & 7),
              corner[1] + static_cast<std::int32_t>((cell >> 3) & 7),
              corner[2] + static_cast<std::int32_t>(cell >> 6), 0};
      const bool ends_inside = distance_sq_m2(ray.dx, ray.dy, ray.dz, voxel_size_m) <= range_sq_m2;
      ray.visits =
          ends_inside ? longest_side(ray) + 1 : visits_within_range(ray, range_sq_m2, voxel_size_m);
      rays.push_back(ray);
    });
  }
}

/// A point that walks a line: per axis the coordinate in the window, as fixed point.
struct Walk {
  std::array<std::int64_t, 3> at, step;

  Walk(const Ray& ray, const std::array<std::int32_t, 3>& sensor) {
    const Line line = line_of(std::max(longest_side(ray), 1));
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

/// Byte address of a voxel; the bit is x % 8. `Number` may be a vector of lanes.
template <typename Number>
inline __attribute__((always_inline)) void address_of(const Number& x, const Number& y,
                                                      const Number& z, int y_shift, int z_shift,
                                                      Number& address) {
  const Number in_block = (y & 7) + ((z & 7) << 3);
  const Number in_tile = ((x & 24) << 3) + ((y & 24) << 5) + ((z & 24) << 7);
  address = in_block + in_tile + ((x >> 5) << 12) + ((y >> 5) << y_shift) + ((z >> 5) << z_shift);
}

/// Lines are looked at every so many steps for the tiles they cross: at most one per axis between.
constexpr std::int32_t kTouchStride = Window::kTileSide;

/// One ray of any length.
void cast(const Ray& ray, const std::array<std::int32_t, 3>& sensor, Window& window) {
  const Walk walk(ray, sensor);
  std::int64_t x = walk.at[0], y = walk.at[1], z = walk.at[2];
  std::uint32_t tile = 0;
  for (std::int32_t i = 0; i < ray.visits; ++i) {
    const auto column = static_cast<std::size_t>(x >> kFraction);
    std::size_t address;
    address_of(column, static_cast<std::size_t>(y >> kFraction),
               static_cast<std::size_t>(z >> kFraction), window.y_shift(), window.z_shift(),
               address);
    window.bits.get()[address] |= static_cast<std::uint8_t>(1u << (column & 7));
    if (i % kTouchStride == 0 || i == ray.visits - 1) {
      const auto here = static_cast<std::uint32_t>(address / Window::kTileBytes);
      if (i == 0) {
        window.touch(here);
      } else {
        window.touch_between(tile, here);
      }
      tile = here;
    }
    x += walk.step[0];
    y += walk.step[1];
    z += walk.step[2];
  }
}

/// Eight rays of similar length in step: 32-bit fixed point, increments rounded up, exact while
/// visits * M < 2^kLaneFraction.
constexpr int kLaneFraction = 21;
constexpr std::int32_t kMaxLaneCoordinate = (1 << (32 - kLaneFraction)) - 2;
using DoubleLanes = double __attribute__((vector_size(8 * kLanes)));

bool fits_lanes(const Ray& ray) {
  return std::int64_t{ray.visits} * longest_side(ray) < (std::int64_t{1} << kLaneFraction);
}

/// Eight Walks of 32 bits.
struct LaneWalks {
  UintLanes at[3], step[3];
  IntLanes last;  ///< step of the last visit
};

inline __attribute__((always_inline)) IntLanes magnitude(const IntLanes& lanes) {
  return lanes < 0 ? -lanes : lanes;
}

/// ceil(numerator * 2^kLaneFraction / divisor), both at least 0.
inline __attribute__((always_inline)) IntLanes scaled_ratio(const IntLanes& numerator,
                                                            const DoubleLanes& divisor) {
  const DoubleLanes ratio = __builtin_convertvector(numerator, DoubleLanes) *
                            static_cast<double>(1 << kLaneFraction) / divisor;
  const IntLanes floor = __builtin_convertvector(ratio, IntLanes);
  const auto cut = __builtin_convertvector(floor, DoubleLanes) < ratio;
  return floor - __builtin_convertvector(cut, IntLanes);
}

/// Walks of `rays`, the last of them repeated to fill the lanes.
inline __attribute__((always_inline)) LaneWalks lane_walks(
    std::span<const Ray> rays, const std::array<std::int32_t, 3>& sensor) {
  LaneWalks walks;
  IntLanes d[3];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Ray& ray = rays[std::min(lane, rays.size() - 1)];
    d[0][lane] = ray.dx;
    d[1][lane] = ray.dy;
    d[2][lane] = ray.dz;
    walks.last[lane] = ray.visits - 1;
  }
  IntLanes longest = IntLanes{} + 1;
  for (const IntLanes& side : d) longest = magnitude(side) > longest ? magnitude(side) : longest;
  const DoubleLanes divisor = __builtin_convertvector(longest, DoubleLanes);
  const IntLanes start = scaled_ratio(longest - 1 - (longest >> 1), divisor);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const IntLanes speed = scaled_ratio(magnitude(d[axis]), divisor);
    const IntLanes offset = d[axis] < 0 ? (1 << kLaneFraction) - 1 - start : start;
    const IntLanes step = d[axis] < 0 ? -speed : speed;
    walks.step[axis] = std::bit_cast<UintLanes>(step);
    walks.at[axis] = std::bit_cast<UintLanes>(offset) +
                     (static_cast<std::uint32_t>(sensor[axis]) << kLaneFraction);
  }
  return walks;
}

/// Out of the hot loop, and only every kTouchStride steps.
[[gnu::noinline]] void touch_lanes(const std::uint32_t* from, const std::uint32_t* to,
                                   Window& window) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    window.touch_between(from[lane] / Window::kTileBytes, to[lane] / Window::kTileBytes);
  }
}

MOSBENCH_MULTIARCH void cast_lanes(std::span<const Ray> rays,
                                   const std::array<std::int32_t, 3>& sensor, Window& window) {
  const LaneWalks walks = lane_walks(rays, sensor);
  // Locals: the byte stores below could otherwise change anything behind a reference.
  std::uint8_t* const bits = window.bits.get();
  const int y_shift = window.y_shift(), z_shift = window.z_shift();
  UintLanes at_x = walks.at[0], at_y = walks.at[1], at_z = walks.at[2];
  UintLanes step_x = walks.step[0], step_y = walks.step[1], step_z = walks.step[2];
  const IntLanes last = walks.last;
  const std::int32_t shortest = rays.front().visits - 1, longest = rays.back().visits - 1;
  alignas(sizeof(UintLanes)) std::uint32_t address[kLanes], mark[kLanes], sampled[kLanes];
  for (std::int32_t i = 0; i <= longest; ++i) {
    const UintLanes x = at_x >> kLaneFraction, y = at_y >> kLaneFraction, z = at_z >> kLaneFraction;
    UintLanes addresses;
    address_of(x, y, z, y_shift, z_shift, addresses);
    // 1 << (x & 7) by way of a float's exponent, as SSE2 cannot shift lanes by different counts.
    const IntLanes marks =
        __builtin_convertvector(std::bit_cast<FloatLanes>(((x & 7) + 127) << 23), IntLanes);
    std::memcpy(address, &addresses, sizeof(address));
    std::memcpy(mark, &marks, sizeof(mark));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      bits[address[lane]] |= static_cast<std::uint8_t>(mark[lane]);
    }
    if (i % kTouchStride == 0 || i == longest) {
      if (i == 0) {
        window.touch(address[0] / Window::kTileBytes);  // all start in the sensor's voxel
      } else {
        touch_lanes(sampled, address, window);
      }
      std::memcpy(sampled, address, sizeof(sampled));
    }
    if (i >= shortest) {  // rays at their end stand still
      const UintLanes walking = std::bit_cast<UintLanes>(last > i);
      step_x &= walking;
      step_y &= walking;
      step_z &= walking;
    }
    at_x += step_x;
    at_y += step_y;
    at_z += step_z;
  }
}

/// Orders rays by length, and rays of one length so that neighbours in the list are not
/// neighbours in space: eight rays in step must not wait for each other's bytes.
void sort_rays(const std::vector<Ray>& rays, std::vector<Ray>& sorted) {
  std::vector<std::uint32_t> first;
  for (const Ray& ray : rays) {
    const auto length = static_cast<std::size_t>(ray.visits);
    if (first.size() <= length + 1) first.resize(length + 2);
    ++first[length + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  sorted.resize(rays.size());
  std::size_t stride = rays.size() * 5 / 8 | 1;
  while (std::gcd(stride, rays.size()) > 1) stride += 2;
  for (std::size_t i = 0, from = 0; i < rays.size(); ++i, from = (from + stride) % rays.size()) {
    sorted[first[static_cast<std::size_t>(rays[from].visits)]++] = rays[from];
  }
}

/// Casts a share of the sorted rays.
void cast_all(std::span<const Ray> rays, const std::array<std::int32_t, 3>& sensor,
              bool window_fits_lanes, Window& window) {
  std::vector<Ray> group;
  for (const Ray& ray : rays) {
    if (window_fits_lanes && fits_lanes(ray)) {
      group.push_back(ray);
    } else {
      cast(ray, sensor, window);
    }
    if (group.size() == kLanes || (&ray == &rays.back() && !group.empty())) {
      cast_lanes(group, sensor, window);
      group.clear();
    }
  }
}

/// Unites the threads' windows as blocks and leaves them all zero.
ObservedVoxels collect_observed(std::vector<Window>& windows, unsigned threads,
                                const std::array<std::int32_t, 3>& first_block) {
  Window& all = windows.front();
  for (unsigned thread = 1; thread < threads; ++thread) {
    for (const std::uint32_t tile : windows[thread].touched_tiles) all.touch(tile);
  }
  ObservedVoxels observed;
  for (const std::uint32_t tile : all.touched_tiles) {
    const std::uint32_t tile_x = tile & ((1u << all.log2_tiles[0]) - 1),
                        tile_y = tile >> all.log2_tiles[0] & ((1u << all.log2_tiles[1]) - 1),
                        tile_z = tile >> (all.log2_tiles[0] + all.log2_tiles[1]);
    for (std::uint32_t block = 0; block < 64; ++block) {
      BlockMask mask;
      for (unsigned thread = 0; thread < threads; ++thread) {
        Window& window = windows[thread];
        if (thread > 0 && window.tile_touched[tile] == 0) continue;
        std::uint8_t* bytes =
            window.bits.get() + std::size_t{tile} * Window::kTileBytes + block * 64;
        BlockMask part;
        std::memcpy(part.words.data(), bytes, sizeof(part.words));
        if (!part.any()) continue;
        mask = mask | part;
        std::memset(bytes, 0, sizeof(part.words));
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

}  // namespace

ObservedVoxels raycast(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                       double max_range_m, RaycastScratch& scratch, ThreadPool& pool) {
  Bounds bounds;
  collect_rays(measured, sensor, voxel_size_m, max_range_m, scratch.rays, bounds);

  const std::array<std::int32_t, 3> s{sensor.x, sensor.y, sensor.z};
  std::array<std::int32_t, 3> first_block{}, sensor_in_window{};
  std::array<int, 3> log2_tiles{};
  bool window_fits_lanes = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_block[axis] = (s[axis] + bounds.low[axis]) >> 3;
    sensor_in_window[axis] = s[axis] - first_block[axis] * kBlockSide;
    const std::int32_t highest = sensor_in_window[axis] + bounds.high[axis];
    log2_tiles[axis] =
        static_cast<int>(std::bit_width(static_cast<std::uint32_t>(highest) / Window::kTileSide));
    window_fits_lanes = window_fits_lanes && highest <= kMaxLaneCoordinate;
  }
  if (scratch.windows.size() < pool.size()) scratch.windows.resize(pool.size());
  for (unsigned thread = 0; thread < pool.size(); ++thread) {
    scratch.windows[thread].lay_out(log2_tiles);
  }
  if (scratch.rays.empty()) return {};
  sort_rays(scratch.rays, scratch.sorted_rays);
  pool.for_ranges(scratch.sorted_rays.size(), 1024,
                  [&](std::size_t begin, std::size_t end, unsigned thread) {
                    cast_all(std::span(scratch.sorted_rays).subspan(begin, end - begin),
                             sensor_in_window, window_fits_lanes, scratch.windows[thread]);
                  });
  return collect_observed(scratch.windows, pool.size(), first_block);
}

}  // namespace mosbench
