#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/simd_lanes.hpp"
#include "core/voxel/grid_walk.hpp"
#include "core/voxel/ray_window.hpp"

/// Eight numbers of 64 bits in two halves: GCC takes wider vectors of conditions apart into single
/// numbers.
namespace mosbench {

using Reals = double __attribute__((vector_size(32)));
using Longs = std::int64_t __attribute__((vector_size(32)));
using Bits = std::uint64_t __attribute__((vector_size(32)));
inline constexpr std::size_t kHalf = 4, kHalves = kLanes / kHalf;

/// Memory for the lanes of both halves.
struct alignas(32) BitArray : std::array<std::uint64_t, kLanes> {};

/// Whether all flags are set.
inline __attribute__((always_inline)) bool all(const Longs& flags) {
  return bits_of(reinterpret_cast<ByteFlags>(flags)) == 0xFFFFFFFF;
}

/// A line through a window, from a voxel on.
struct ExactRay {
  BorderCrossings crossings;
  double length_m;
  std::uint64_t start, end;  ///< bits of the window
  std::uint32_t steps;       ///< about so many to the end; rays of similar length walk together
};

/// Rays that are walked together, one in each lane.
inline constexpr std::size_t kRaysTogether = 8;
using RayGroup = std::array<const ExactRay*, kRaysTogether>;
/// Deals rays of similar length into groups of eight that come from different regions, so that they
/// do not write to the same cache lines. A run of n similar rays is cut into eight parts, and each
/// part gives one ray to every group. The last groups are filled up with the longest ray.
std::vector<RayGroup> groups_of(std::span<const ExactRay> rays);

/// How far rays go.
enum class RayEnd {
  /// Up to, not including, the voxel `end`, or as long as the next border is within the length
  /// (OctoMap's computeRayKeys, which adds its first voxel always).
  kBeforeEnd,
  /// While the next border is nearer than the length, up to and including the first voxel that is
  /// set in a second window (UFOMap's computeRay).
  kAtHit
};

/// Marks the voxels that the rays cross in `window`, eight rays in step. `hits` has the same
/// layout, and is not read for kBeforeEnd. Afterwards every ray also marks the voxels up to the
/// first one that is `beyond_voxels` from its last along one axis.
void cast_exact(std::span<const ExactRay> rays, RayEnd until, const RayWindow& hits,
                int beyond_voxels, RayWindow& window);

}  // namespace mosbench
