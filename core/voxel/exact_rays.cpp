#include "core/voxel/exact_rays.hpp"

#include "core/base/multiarch.hpp"

namespace mosbench {
namespace {

static_assert(kRaysTogether == kLanes);

/// Half of eight rays on their way.
struct HalfGroup {
  Reals next[3], pace[3], length;
  Bits change[3];  ///< what is added to the bits of an axis
  Bits at, end;
  Longs stopped;
};
using Group = std::array<HalfGroup, kHalves>;

Group group_of(const RayGroup& rays, const WindowBits& bits) {
  Group group{};
  for (std::size_t i = 0; i < kLanes; ++i) {
    const ExactRay& ray = *rays[i];
    HalfGroup& half = group[i / kHalf];
    const std::size_t lane = i % kHalf;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half.next[axis][lane] = ray.crossings.next_m[axis];
      half.pace[axis][lane] = ray.crossings.pace_m[axis];
      half.change[axis][lane] = bits.change(axis, ray.crossings.back[axis]);
    }
    half.length[lane] = ray.length_m;
    half.at[lane] = ray.start;
    half.end[lane] = ray.end;
  }
  return group;
}

[[gnu::noinline]] void touch_group(const BitArray& from, const BitArray& to,
                                   RayWindow::Tiles tiles) {
  const auto tile = [](std::uint64_t byte) {
    return static_cast<std::uint32_t>(byte / RayWindow::kTileBytes);
  };
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    tiles.touch_between(tile(from[lane]), tile(to[lane]));
  }
}

/// Bits of the axes, as WindowBits::of_axis.
struct AxisBits {
  std::uint64_t x, y, z;
};

/// Stops the rays that stand on a hit.
[[gnu::noinline]] void stop_at_hits(const std::uint8_t* hits, const BitArray& place,
                                    const BitArray& mark, HalfGroup& low, HalfGroup& high) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if ((hits[place[lane]] & mark[lane]) == 0) continue;
    (lane < kHalf ? low : high).stopped[lane % kHalf] = -1;
  }
}

/// Moves four rays to their next voxels, unless they stop.
template <RayEnd until>
inline __attribute__((always_inline)) void advance(HalfGroup& rays, const AxisBits& axes) {
  // The order of comparisons decides which of two equal borders comes first.
  const Longs x_before_y = rays.next[0] < rays.next[1];
  const Reals nearer = x_before_y ? rays.next[0] : rays.next[1];
  const Longs not_z = nearer < rays.next[2];
  const Longs along_x = x_before_y & not_z, along_y = ~x_before_y & not_z;
  const Bits x = Bits(along_x), y = Bits(along_y), z = ~Bits(not_z);
  const Bits own = (x & axes.x) | (y & axes.y) | (z & axes.z);
  const Bits change = (x & rays.change[0]) | (y & rays.change[1]) | (z & rays.change[2]);
  const Bits to = (((rays.at & own) + change) & own) | (rays.at & ~own);
  const Reals to_x = along_x ? rays.next[0] + rays.pace[0] : rays.next[0];
  const Reals to_y = along_y ? rays.next[1] + rays.pace[1] : rays.next[1];
  const Reals to_z = not_z ? rays.next[2] : rays.next[2] + rays.pace[2];
  if constexpr (until == RayEnd::kAtHit) {
    rays.stopped |= (not_z ? nearer : rays.next[2]) >= rays.length;
  } else {
    const Reals xy = to_x < to_y ? to_x : to_y;
    rays.stopped |= Longs(to == rays.end) | ((xy < to_z ? xy : to_z) > rays.length);
  }
  const Bits stays = Bits(rays.stopped);
  rays.at = (rays.at & stays) | (to & ~stays);
  rays.next[0] = rays.stopped ? rays.next[0] : to_x;
  rays.next[1] = rays.stopped ? rays.next[1] : to_y;
  rays.next[2] = rays.stopped ? rays.next[2] : to_z;
}

/// Walks eight rays to their ends.
template <RayEnd until>
inline __attribute__((always_inline)) void walk(Group& group, const AxisBits& axes,
                                                const std::uint8_t* hits, RayWindow& window) {
  // Locals: the byte stores below could otherwise change anything behind a reference.
  std::uint8_t* const bytes = window.bits();
  const RayWindow::Tiles tiles = window.tiles();
  HalfGroup low = group[0], high = group[1];
  BitArray place, mark, sampled;
  for (int step = 0;; ++step) {
    store(low.at >> 3, place.data());
    store(high.at >> 3, place.data() + kHalf);
    store((Bits{} + 1) << (low.at & 7), mark.data());
    store((Bits{} + 1) << (high.at & 7), mark.data() + kHalf);
    // A lane extracted from a register costs two operations, a loaded one: force loads.
    __asm__("" : "+m"(place), "+m"(mark));
    if (step == 0) sampled = place;
    std::uint64_t found = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::uint64_t byte = place[lane];
      bytes[byte] |= static_cast<std::uint8_t>(mark[lane]);
      if constexpr (until == RayEnd::kAtHit) found |= hits[byte] & mark[lane];
    }
    if (step % RayWindow::kTileSide == 0) {
      touch_group(sampled, place, tiles);
      sampled = place;
    }
    // Rarely, so that no lane waits for a vector made of numbers just stored.
    if (found != 0) stop_at_hits(hits, place, mark, low, high);
    advance<until>(low, axes);
    advance<until>(high, axes);
    if (all(low.stopped & high.stopped)) break;
  }
  touch_group(sampled, place, tiles);
  group = {low, high};
}

MOSBENCH_MULTIARCH void walk_before_end(Group& group, const AxisBits& axes, RayWindow& window) {
  walk<RayEnd::kBeforeEnd>(group, axes, nullptr, window);
}

MOSBENCH_MULTIARCH void walk_to_hit(Group& group, const AxisBits& axes, const RayWindow& hits,
                                    RayWindow& window) {
  walk<RayEnd::kAtHit>(group, axes, hits.bits(), window);
}

/// Marks the voxels beyond the ends of eight rays.
void go_beyond(const RayGroup& rays, const Group& group, const WindowBits& bits, int beyond_voxels,
               WindowPen& pen) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    BorderCrossings crossings = rays[lane]->crossings;
    const HalfGroup& half = group[lane / kHalf];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      crossings.next_m[axis] = half.next[axis][lane % kHalf];
    }
    WindowWalk walk(bits, half.at[lane % kHalf], crossings);
    std::array<int, 3> moved{};
    for (std::size_t axis = 0; moved[axis] != beyond_voxels; ++moved[axis]) {
      axis = walk.advance();
      pen.mark(walk.at());
    }
  }
}

}  // namespace

std::vector<RayGroup> groups_of(std::span<const ExactRay> rays) {
  constexpr std::uint32_t kSimilar_steps = 8;
  std::vector<std::uint32_t> first;
  for (const ExactRay& ray : rays) {
    const std::size_t run = ray.steps / kSimilar_steps + 1;
    if (first.size() <= run) first.resize(run + 1);
    ++first[run];
  }
  for (std::size_t run = 1; run < first.size(); ++run) first[run] += first[run - 1];
  std::vector<const ExactRay*> ordered(rays.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const ExactRay& ray : rays) ordered[next[ray.steps / kSimilar_steps]++] = &ray;
  std::vector<RayGroup> groups;
  std::size_t lane = kLanes;
  for (std::size_t run = 0; run + 1 < first.size(); ++run) {
    const std::size_t rows = (first[run + 1] - first[run] + kLanes - 1) / kLanes;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t i = first[run] + row; i < first[run + 1]; i += rows) {
        if (lane == kLanes) {
          groups.emplace_back().fill(ordered.back());
          lane = 0;
        }
        groups.back()[lane++] = ordered[i];
      }
    }
  }
  return groups;
}

void cast_exact(std::span<const ExactRay> rays, RayEnd until, const RayWindow& hits,
                int beyond_voxels, RayWindow& window) {
  if (rays.empty()) return;
  const WindowBits bits(window);
  const AxisBits axes{bits.of_axis(0), bits.of_axis(1), bits.of_axis(2)};
  WindowPen pen(window);
  for (const RayGroup& together : groups_of(rays)) {
    Group group = group_of(together, bits);
    if (until == RayEnd::kBeforeEnd) {
      walk_before_end(group, axes, window);
    } else {
      walk_to_hit(group, axes, hits, window);
    }
    if (beyond_voxels > 0) go_beyond(together, group, bits, beyond_voxels, pen);
  }
}

}  // namespace mosbench
