#include "core/voxel/ray_runs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/multiarch.hpp"

namespace mosbench {
namespace {

/// Nearer to a border than this, in voxels, a position may be on either side. Crossings are added
/// up in cast_exact, at most thousands of them, with errors below 1e-9 voxels.
constexpr double kDoubt_voxels = 1e-6;

/// The axes of a window whose bytes lie along the first one.
struct Axes {
  explicit Axes(const RayWindow& window)
      : along(window.bytes_along() == RayWindow::BytesAlong::kX ? 0 : 1), beside(1 - along) {}

  std::size_t along, beside;
  static constexpr std::size_t kUp = 2;
};

/// Half of eight rays on their way. Crossings are those of the axes beside and up, and of the
/// borders of bytes.
struct HalfRuns {
  Reals next[3], pace[3], length;
  Reals offset, rate;  ///< half a voxel less than the place along the bytes is offset + t rate
  Bits change[3];
  Bits at;    ///< bit of the byte
  Bits from;  ///< of the byte's bits, the first one of the run; the last one of a ray that stopped
  Bits back;  ///< all bits where rays go towards lower bits
  Longs stopped, doubtful;
};
using RunGroup = std::array<HalfRuns, kHalves>;

/// Bits of the window's axes, in the order of HalfRuns.
using OwnBits = std::array<std::uint64_t, 3>;

RunGroup group_of(const RayGroup& rays, const Axes& axes, const OwnBits& own) {
  RunGroup group{};
  for (std::size_t i = 0; i < kLanes; ++i) {
    const BorderCrossings& crossings = rays[i]->crossings;
    HalfRuns& half = group[i / kHalf];
    const std::size_t lane = i % kHalf;
    const std::array<std::size_t, 3> order{axes.beside, Axes::kUp, axes.along};
    for (std::size_t k = 0; k < 3; ++k) {
      half.next[k][lane] = crossings.next_m[order[k]];
      half.pace[k][lane] = crossings.pace_m[order[k]];
      half.change[k][lane] = WindowBits::change_of(own[k], crossings.back[order[k]]);
    }
    const std::uint64_t first = rays[i]->start & 7;
    const bool back = crossings.back[axes.along];
    const double pace_m = crossings.pace_m[axes.along], next_m = crossings.next_m[axes.along];
    half.next[2][lane] = next_m + static_cast<double>(back ? first : 7 - first) * pace_m;
    half.pace[2][lane] = 8 * pace_m;
    half.rate[lane] = (back ? -1 : 1) / pace_m;
    const double border = static_cast<double>(back ? first : first + 1);
    half.offset[lane] = border - next_m * half.rate[lane] - 0.5;
    half.length[lane] = rays[i]->length_m;
    half.at[lane] = rays[i]->start & ~std::uint64_t{7};
    half.from[lane] = first;
    half.back[lane] = back ? ~std::uint64_t{0} : 0;
  }
  return group;
}

/// How runs of four rays end.
struct RunEnds {
  Longs beside, up, along;  ///< which border is crossed
  Longs ends;               ///< no border: the ray is over
  Bits to;                  ///< last bit of the run
};

inline __attribute__((always_inline)) RunEnds ends_of(HalfRuns& rays) {
  const Longs beside_first = rays.next[0] < rays.next[1];
  const Reals nearer = beside_first ? rays.next[0] : rays.next[1];
  const Longs along = rays.next[2] < nearer;
  const Reals nearest = along ? rays.next[2] : nearer;
  const Longs ends = nearest >= rays.length;
  const Longs at_border = along & ~ends;
  const Reals place = (ends ? rays.length : nearest) * rays.rate + rays.offset;
  // The sum's last bit is worth one, so that it ends with the nearest whole number.
  constexpr double kWhole = 6755399441055744.0;  // 1.5 * 2^52
  const Reals whole = place + kWhole;
  const Reals from_middle = place - (whole - kWhole);
  constexpr double kCertain = 0.5 - kDoubt_voxels;
  rays.doubtful |= ~at_border & (from_middle * from_middle > kCertain * kCertain);
  const Bits last_of_byte = ~rays.back & 7;
  const Bits to = (Bits(at_border) & last_of_byte) | (~Bits(at_border) & Bits(whole) & 7);
  return {beside_first & ~along, ~beside_first & ~along, along, ends, to};
}

/// Returns the bits of the runs that are to be marked.
inline __attribute__((always_inline)) Bits run_of(const HalfRuns& rays, const RunEnds& ends) {
  const Bits swapped = (rays.from ^ ends.to) & rays.back;
  const Bits low = rays.from ^ swapped, high = ends.to ^ swapped;
  const Bits run = ((Bits{} + 2) << high) - ((Bits{} + 1) << low);
  return run & ~Bits(rays.stopped | rays.doubtful);
}

/// Moves four rays across the borders where their runs ended, unless they stop.
inline __attribute__((always_inline)) void advance(HalfRuns& rays, const RunEnds& ends,
                                                   const OwnBits& own_bits) {
  const Longs goes_on = ~(rays.stopped | rays.doubtful | ends.ends);
  const Bits last = (Bits(rays.stopped) & rays.from) | (~Bits(rays.stopped) & ends.to);
  rays.stopped = ~goes_on;
  const Longs beside = ends.beside & goes_on, up = ends.up & goes_on, along = ends.along & goes_on;
  const Bits own =
      (Bits(beside) & own_bits[0]) | (Bits(up) & own_bits[1]) | (Bits(along) & own_bits[2]);
  const Bits change = (Bits(beside) & rays.change[0]) | (Bits(up) & rays.change[1]) |
                      (Bits(along) & rays.change[2]);
  rays.at = (((rays.at & own) + change) & own) | (rays.at & ~own);
  rays.next[0] = beside ? rays.next[0] + rays.pace[0] : rays.next[0];
  rays.next[1] = up ? rays.next[1] + rays.pace[1] : rays.next[1];
  rays.next[2] = along ? rays.next[2] + rays.pace[2] : rays.next[2];
  rays.from = (Bits(along) & rays.back & 7) | (~Bits(along) & last);
}

/// Ends a run at its first hit, where the ray stops. Returns what is left of it.
[[gnu::noinline]] std::uint64_t stop_at_hit(std::uint64_t run, std::uint64_t hit, std::size_t lane,
                                            RunGroup& group) {
  HalfRuns& rays = group[lane / kHalf];
  const bool back = rays.back[lane % kHalf] != 0;
  const auto first = back ? static_cast<std::uint64_t>(std::bit_width(hit)) - 1
                          : static_cast<std::uint64_t>(std::countr_zero(hit));
  rays.stopped[lane % kHalf] = -1;
  rays.from[lane % kHalf] = first;
  const std::uint64_t below = (std::uint64_t{2} << first) - 1;
  return run & (back ? ~(below >> 1) : below);
}

/// Walks eight rays to their ends.
MOSBENCH_MULTIARCH_V4 void walk_runs(RunGroup& group, const OwnBits& own, const std::uint8_t* hits,
                                     RayWindow& window) {
  // Locals: the byte stores below could otherwise change anything behind a reference.
  std::uint8_t* const bytes = window.bits();
  const RayWindow::Tiles tiles = window.tiles();
  const OwnBits own_bits = own;
  RunGroup rays = group;
  BitArray place, run;
  for (;;) {
    const RunEnds low = ends_of(rays[0]), high = ends_of(rays[1]);
    store(rays[0].at >> 3, place.data());
    store(rays[1].at >> 3, place.data() + kHalf);
    store(run_of(rays[0], low), run.data());
    store(run_of(rays[1], high), run.data() + kHalf);
    // A lane extracted from a register costs two operations, a loaded one: force loads.
    __asm__("" : "+m"(place), "+m"(run));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::uint64_t byte = place[lane];
      std::uint64_t marks = run[lane];
      const std::uint64_t hit = hits[byte] & marks;
      if (__builtin_expect(hit != 0, 0)) marks = stop_at_hit(marks, hit, lane, rays);
      bytes[byte] |= static_cast<std::uint8_t>(marks);
      tiles.touch(byte);
    }
    advance(rays[0], low, own_bits);
    advance(rays[1], high, own_bits);
    if (all(rays[0].stopped & rays[1].stopped)) break;
  }
  group = rays;
}

/// Marks the voxels beyond the end of a ray, until one is `beyond_voxels` from it along one axis.
/// Returns false where rounding might decide which come next.
bool go_beyond(const BorderCrossings& end, std::uint64_t at, const Axes& axes, int beyond_voxels,
               const WindowBits& bits, WindowPen& pen) {
  WindowWalk walk(bits, at, end);
  std::array<int, 3> moved{};
  for (std::size_t axis = 0; moved[axis] != beyond_voxels; ++moved[axis]) {
    const double others_m = std::min(walk.next_m(axes.beside), walk.next_m(Axes::kUp));
    const double doubt_m = kDoubt_voxels * end.pace_m[axes.along];
    if (std::abs(walk.next_m(axes.along) - others_m) < doubt_m) return false;
    axis = walk.advance();
    pen.mark(walk.at());
  }
  return true;
}

/// Returns where a ray that stopped would cross borders next.
BorderCrossings crossings_at_end(const ExactRay& ray, const HalfRuns& half, std::size_t lane,
                                 const Axes& axes) {
  BorderCrossings end = ray.crossings;
  const std::uint64_t last = half.from[lane];
  const std::uint64_t voxels = half.back[lane] != 0 ? last : 7 - last;
  end.next_m[axes.beside] = half.next[0][lane];
  end.next_m[Axes::kUp] = half.next[1][lane];
  end.next_m[axes.along] =
      half.next[2][lane] - static_cast<double>(voxels) * end.pace_m[axes.along];
  return end;
}

}  // namespace

void cast_runs(std::span<const ExactRay> rays, const RayWindow& hits, int beyond_voxels,
               RayWindow& window, std::vector<ExactRay>& doubtful) {
  if (rays.empty()) return;
  const Axes axes(window);
  const WindowBits bits(window);
  const OwnBits own{bits.of_axis(axes.beside), bits.of_axis(Axes::kUp),
                    bits.of_axis(axes.along) & ~std::uint64_t{7}};
  WindowPen pen(window);
  for (const RayGroup& together : groups_of(rays)) {
    RunGroup group = group_of(together, axes, own);
    walk_runs(group, own, hits.bits(), window);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const HalfRuns& half = group[i / kHalf];
      const std::size_t lane = i % kHalf;
      const bool is_certain =
          half.doubtful[lane] == 0 &&
          (beyond_voxels == 0 ||
           go_beyond(crossings_at_end(*together[i], half, lane, axes),
                     half.at[lane] | half.from[lane], axes, beyond_voxels, bits, pen));
      if (!is_certain) doubtful.push_back(*together[i]);
    }
  }
}

}  // namespace mosbench
