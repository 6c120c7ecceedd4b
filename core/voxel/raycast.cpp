#include "core/voxel/raycast.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench {
namespace {

double distance_sq_m2(std::int32_t dx, std::int32_t dy, std::int32_t dz, double voxel_size_m) {
  const double x = dx * voxel_size_m, y = dy * voxel_size_m, z = dz * voxel_size_m;
  return (x * x + y * y) + z * z;
}

/// Number of voxels within range on the line to a voxel beyond it. The distance never falls
/// along a line, so a guess from the ratio of lengths is corrected step by step.
std::int32_t visits_within_range(const Ray& ray, double range_sq_m2, double voxel_size_m) {
  const std::int32_t longest = longest_side(ray);
  const Line line(longest);
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

std::array<std::int32_t, 3> corner_from_sensor(const RaySource& source, std::size_t slot) {
  const Voxel first = voxel_at(source.measured.blocks[slot], 0);
  return {first.x - source.sensor.x, first.y - source.sensor.y, first.z - source.sensor.z};
}

/// Farthest coordinate of a block from the sensor along one axis.
std::int32_t farthest(std::int32_t corner) {
  return std::max(std::abs(corner), std::abs(corner + kBlockSide - 1));
}

void append_ray(const Ray& ray, std::int64_t short_limit, Rays& rays) {
  const std::int32_t longest = longest_side(ray);
  if (longest <= INT16_MAX && std::int64_t{ray.visits} * longest < short_limit) {
    rays.unordered.push_back({static_cast<std::int16_t>(ray.dx), static_cast<std::int16_t>(ray.dy),
                              static_cast<std::int16_t>(ray.dz),
                              static_cast<std::int16_t>(ray.visits)});
  } else {
    rays.long_rays.push_back(ray);
  }
}

void append_rays(const RaySource& source, std::size_t slot, std::int64_t short_limit, Rays& rays) {
  const double range_sq_m2 = source.max_range_m * source.max_range_m;
  const auto corner = corner_from_sensor(source, slot);
  const bool all_inside = distance_sq_m2(farthest(corner[0]), farthest(corner[1]),
                                         farthest(corner[2]), source.voxel_size_m) <= range_sq_m2;
  for_each_cell(source.measured.masks[slot], [&](std::uint32_t cell) {
    Ray ray{corner[0] + static_cast<std::int32_t>(cell & 7),
            corner[1] + static_cast<std::int32_t>((cell >> 3) & 7),
            corner[2] + static_cast<std::int32_t>(cell >> 6), 0};
    const bool inside =
        all_inside || distance_sq_m2(ray.dx, ray.dy, ray.dz, source.voxel_size_m) <= range_sq_m2;
    ray.visits =
        inside ? longest_side(ray) + 1 : visits_within_range(ray, range_sq_m2, source.voxel_size_m);
    append_ray(ray, short_limit, rays);
  });
}

/// Places of the rays with one number of visits, as a table of eight columns that is filled column
/// by column. The eight of a row are cast together and come from distant parts of the scan.
struct Bucket {
  std::uint32_t begin = 0, rows = 0, row = 0, column = 0, rest = 0;

  std::uint32_t next() {
    if (column == 8 || rows == 0) return begin + rows * 8 + rest++;
    const std::uint32_t place = begin + row * 8 + column;
    if (++row == rows) {
      row = 0;
      ++column;
    }
    return place;
  }
};

void order(const std::vector<ShortRay>& unordered, std::vector<ShortRay>& ordered) {
  std::vector<std::uint32_t> counts;
  for (const ShortRay& ray : unordered) {
    const auto visits = static_cast<std::size_t>(ray.visits);
    if (counts.size() <= visits) counts.resize(visits + 1);
    ++counts[visits];
  }
  std::vector<Bucket> buckets;
  std::uint32_t begin = 0;
  for (const std::uint32_t count : counts) {
    buckets.push_back({.begin = begin, .rows = count / 8});
    begin += count;
  }
  ordered.resize(unordered.size());
  for (const ShortRay& ray : unordered) {
    ordered[buckets[static_cast<std::size_t>(ray.visits)].next()] = ray;
  }
}

/// Where rays start, in voxels from the window's low corner.
using Start = std::array<std::int32_t, 3>;

/// A point that walks a line: per axis the coordinate in the window, as fixed point.
struct Walk {
  std::array<std::uint64_t, 3> at, step;

  Walk(const Ray& ray, const Start& sensor) {
    const Line line(std::max(longest_side(ray), 1));
    const std::array<std::int32_t, 3> d{ray.dx, ray.dy, ray.dz};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t from = std::int64_t{sensor[axis]} << kLineFraction;
      const std::int64_t speed = std::abs(d[axis]) * line.reciprocal;
      // s - floor(a) is floor(s + 1 - a) less the smallest unit.
      const std::int64_t back = (std::int64_t{1} << kLineFraction) - 1 - line.start;
      at[axis] = static_cast<std::uint64_t>(from + (d[axis] < 0 ? back : line.start));
      step[axis] = static_cast<std::uint64_t>(d[axis] < 0 ? -speed : speed);
    }
  }
};

/// The tile of a ray is sampled every kTouchStride steps; in between it changes by at most one per
/// axis.
constexpr std::int32_t kTouchStride = RayWindow::kTileSide;

/// One ray of any length.
void cast(const Ray& ray, const Start& sensor, RayWindow& window) {
  const Walk walk(ray, sensor);
  std::uint64_t x = walk.at[0], y = walk.at[1], z = walk.at[2];
  std::uint32_t tile = 0;
  for (std::int32_t i = 0; i < ray.visits; ++i) {
    const std::uint64_t address =
        address_of<kLineFraction>(x, y, z, window.y_shift(), window.z_shift());
    window.bits()[address] |= static_cast<std::uint8_t>(1u << (x >> kLineFraction & 7));
    if (i % kTouchStride == 0 || i == ray.visits - 1) {
      const auto here = static_cast<std::uint32_t>(address / RayWindow::kTileBytes);
      window.tiles().touch_between(i == 0 ? here : tile, here);
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

/// Eight Walks of 32 bits.
struct LaneWalks {
  UintLanes at[3], step[3];
  IntLanes last;  ///< step of the last visit
};

/// ceil(numerator * 2^kLaneFraction / divisor), both at least 0; `per_unit` is 2^kLaneFraction /
/// divisor. Its rounding may add one where the quotient is whole, which the limit above allows.
inline __attribute__((always_inline)) IntLanes scaled_ratio(const IntLanes& numerator,
                                                            const DoubleLanes& per_unit) {
  const DoubleLanes ratio = __builtin_convertvector(numerator, DoubleLanes) * per_unit;
  const IntLanes floor = __builtin_convertvector(ratio, IntLanes);
  const auto cut = __builtin_convertvector(floor, DoubleLanes) < ratio;
  return floor - __builtin_convertvector(cut, IntLanes);
}

/// Walks of eight rays.
inline __attribute__((always_inline)) LaneWalks lane_walks(const ShortRay* rays,
                                                           const Start& sensor) {
  static_assert(sizeof(ShortRay) == 8);
  LaneWalks walks;
  const auto some = load<IntLanes>(rays), more = load<IntLanes>(rays + 4);
  const IntLanes xy = __builtin_shufflevector(some, more, 0, 2, 4, 6, 8, 10, 12, 14);
  const IntLanes z_visits = __builtin_shufflevector(some, more, 1, 3, 5, 7, 9, 11, 13, 15);
  const IntLanes d[3] = {xy << 16 >> 16, xy >> 16, z_visits << 16 >> 16};
  walks.last = (z_visits >> 16) - 1;
  IntLanes longest = IntLanes{} + 1;
  for (const IntLanes& side : d) longest = magnitude(side) > longest ? magnitude(side) : longest;
  const DoubleLanes per_unit =
      static_cast<double>(1 << kLaneFraction) / __builtin_convertvector(longest, DoubleLanes);
  const IntLanes start = scaled_ratio(longest - 1 - (longest >> 1), per_unit);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const IntLanes speed = scaled_ratio(magnitude(d[axis]), per_unit);
    const IntLanes offset = d[axis] < 0 ? (1 << kLaneFraction) - 1 - start : start;
    const IntLanes step = d[axis] < 0 ? -speed : speed;
    walks.step[axis] = std::bit_cast<UintLanes>(step);
    walks.at[axis] = std::bit_cast<UintLanes>(offset) +
                     (static_cast<std::uint32_t>(sensor[axis]) << kLaneFraction);
  }
  return walks;
}

/// Out of the hot loop, and only every kTouchStride steps.
[[gnu::noinline]] void touch_lanes(const LaneArray& from, const LaneArray& to,
                                   RayWindow::Tiles tiles) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    tiles.touch_between(from[lane] / RayWindow::kTileBytes, to[lane] / RayWindow::kTileBytes);
  }
}

/// Eight rays, the last one the longest.
MOSBENCH_MULTIARCH void cast_lanes(const ShortRay* rays, const Start& sensor, RayWindow& window) {
  const LaneWalks walks = lane_walks(rays, sensor);
  // Locals: the byte stores below could otherwise change anything behind a reference.
  std::uint8_t* const bits = window.bits();
  const RayWindow::Tiles tiles = window.tiles();
  const int y_shift = window.y_shift(), z_shift = window.z_shift();
  UintLanes at_x = walks.at[0], at_y = walks.at[1], at_z = walks.at[2];
  UintLanes step_x = walks.step[0], step_y = walks.step[1], step_z = walks.step[2];
  const IntLanes last = walks.last;
  const std::int32_t shortest = rays[0].visits - 1, longest = rays[kLanes - 1].visits - 1;
  LaneArray address, mark, sampled;
  for (std::int32_t i = 0; i <= longest; ++i) {
    store(address_of<kLaneFraction>(at_x, at_y, at_z, y_shift, z_shift), address);
    // 1 << (x & 7) by way of a float's exponent, as SSE2 cannot shift lanes by different counts.
    const UintLanes exponent = (at_x << (23 - kLaneFraction) & (7u << 23)) + (127u << 23);
    store(__builtin_convertvector(std::bit_cast<FloatLanes>(exponent), IntLanes), mark);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      bits[address[lane]] |= static_cast<std::uint8_t>(mark[lane]);
    }
    if (i % kTouchStride == 0 || i == longest) {
      // All start in the sensor's voxel.
      touch_lanes(i == 0 ? address : sampled, address, tiles);
      sampled = address;
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

void cast_all(const Rays& rays, const Start& sensor, RayWindow& window) {
  for (const Ray& ray : rays.long_rays) cast(ray, sensor, window);
  const std::span<const ShortRay> short_rays = rays.short_rays;
  const std::size_t whole = short_rays.size() / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) cast_lanes(&short_rays[i], sensor, window);
  if (whole == short_rays.size()) return;
  std::array<ShortRay, kLanes> rest;
  rest.fill(short_rays.back());
  std::ranges::copy(short_rays.subspan(whole), rest.begin());
  cast_lanes(rest.data(), sensor, window);
}

/// Returns a box around every voxel that rays of some sources visit.
RayBounds bounds_around(std::span<const RaySource> sources) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  RayBounds all{{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}};
  for (const RaySource& source : sources) {
    const RayBounds own = bounds_of(source);
    const Start sensor{source.sensor.x, source.sensor.y, source.sensor.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.low[axis] = std::min(all.low[axis], sensor[axis] + own.low[axis]);
      all.high[axis] = std::max(all.high[axis], sensor[axis] + own.high[axis]);
    }
  }
  return all;
}

}  // namespace

std::int32_t longest_side(const Ray& ray) {
  return std::max({std::abs(ray.dx), std::abs(ray.dy), std::abs(ray.dz)});
}

Line::Line(std::int32_t longest)
    : reciprocal((std::int64_t{1} << kLineFraction) / longest + 1),
      start((longest - 1 - longest / 2) * reciprocal) {}

std::int32_t Line::moves(std::int32_t distance, std::int32_t step) const {
  const std::int64_t numerator = std::int64_t{step} * std::abs(distance);
  const auto moved = static_cast<std::int32_t>((numerator * reciprocal + start) >> kLineFraction);
  return distance < 0 ? -moved : moved;
}

void collect_rays(const RaySource& source, BlockShare share, std::int64_t short_limit, Rays& rays) {
  rays.unordered.clear();
  rays.long_rays.clear();
  for (std::size_t slot = share.first; slot < source.measured.block_count(); slot += share.stride) {
    append_rays(source, slot, short_limit, rays);
  }
  order(rays.unordered, rays.short_rays);
}

std::size_t Rays::memory_bytes() const {
  return (short_rays.capacity() + unordered.capacity()) * sizeof(ShortRay) +
         long_rays.capacity() * sizeof(Ray);
}

RayBounds bounds_of(const RaySource& source) {
  // Rays that end outside the range stop there.
  const auto reach =
      static_cast<std::int32_t>(std::ceil(source.max_range_m / source.voxel_size_m)) + 1;
  RayBounds bounds;
  for (std::size_t slot = 0; slot < source.measured.block_count(); ++slot) {
    const auto corner = corner_from_sensor(source, slot);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = std::min(bounds.low[axis], std::max(corner[axis], -reach));
      bounds.high[axis] =
          std::max(bounds.high[axis], std::min(corner[axis] + kBlockSide - 1, reach));
    }
  }
  return bounds;
}

std::size_t RaycastScratch::memory_bytes() const {
  std::size_t bytes = 0;
  for (const Rays& part : rays) bytes += part.memory_bytes();
  for (const RayWindow& window : windows) bytes += window.memory_bytes();
  return bytes;
}

std::vector<RaySource> ray_sources(const VoxelizedScan& scan, double voxel_size_m,
                                   double max_range_m) {
  std::vector<RaySource> sources;
  scan.for_each_origin([&](const auto&, const Voxel& sensor, const VoxelSet& measured) {
    sources.push_back({measured, sensor, voxel_size_m, max_range_m});
  });
  return sources;
}

VoxelList raycast(std::span<const RaySource> sources, RaycastScratch& scratch, ThreadPool& pool) {
  if (sources.empty() || sources.front().measured.block_count() == 0) return {};
  const RayBounds bounds = bounds_around(sources);
  Start first_block{};
  std::array<int, 3> log2_tiles{};
  bool window_fits_lanes = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_block[axis] = bounds.low[axis] >> 3;
    const std::int32_t highest = bounds.high[axis] - first_block[axis] * kBlockSide;
    log2_tiles[axis] = static_cast<int>(
        std::bit_width(static_cast<std::uint32_t>(highest / RayWindow::kTileSide)));
    window_fits_lanes = window_fits_lanes && highest <= kMaxLaneCoordinate;
  }
  scratch.windows.resize(pool.size());
  scratch.rays.resize(pool.size());
  for (RayWindow& window : scratch.windows) window.lay_out(log2_tiles);

  const std::int64_t short_limit = window_fits_lanes ? std::int64_t{1} << kLaneFraction : 0;
  // Every share has blocks from all directions, so that all take about as long.
  const std::size_t shares = pool.size() == 1 ? 1 : std::size_t{4} * pool.size();
  pool.for_ranges(shares, 1, [&](std::size_t share, std::size_t, unsigned thread) {
    Rays& rays = scratch.rays[thread];
    for (const RaySource& source : sources) {
      const Start start{source.sensor.x - first_block[0] * kBlockSide,
                        source.sensor.y - first_block[1] * kBlockSide,
                        source.sensor.z - first_block[2] * kBlockSide};
      collect_rays(source, {share, shares}, short_limit, rays);
      cast_all(rays, start, scratch.windows[thread]);
    }
  });
  return collect(scratch.windows, {first_block[0], first_block[1], first_block[2]}, pool);
}

}  // namespace mosbench
