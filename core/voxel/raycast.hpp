#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/ray_window.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench {

/// The line from the sensor's voxel to a measured one, which lies at most 2^19 voxels away per
/// axis.
struct Ray {
  std::int32_t dx, dy, dz;  ///< measured voxel - sensor voxel
  std::int32_t visits;      ///< voxels within range, from the sensor's own
};

std::int32_t longest_side(const Ray& ray);

/// A ray to a voxel near enough for 16 bits.
struct ShortRay {
  std::int16_t dx, dy, dz, visits;
};

/// Rays that are cast eight in step, and the rest.
struct Rays {
  std::vector<ShortRay> short_rays;  ///< by number of visits
  std::vector<Ray> long_rays;
  std::vector<ShortRay> unordered;  ///< scratch

  std::size_t memory_bytes() const;
};

/// Bresenham's line in closed form. With M the longest side and h = M / 2, an axis has moved
/// floor((i d + M - 1 - h) / M) times after i steps: the error terms of raycast.hpp, summed. The
/// quotient is taken in fixed point with a reciprocal rounded up, exact while (i + 1) M^2 <
/// 2^kLineFraction.
inline constexpr int kLineFraction = 50;
struct Line {
  explicit Line(std::int32_t longest);
  std::int32_t moves(std::int32_t distance, std::int32_t step) const;

  std::int64_t reciprocal, start;
};

/// The inputs of casting rays.
struct RaySource {
  const VoxelSet& measured;
  Voxel sensor;
  double voxel_size_m, max_range_m;
};

/// Which of the measured blocks: first, first + stride, ...
struct BlockShare {
  std::size_t first = 0, stride = 1;
};

/// One ray per measured voxel of the share. A ray is short when visits * longest side is below
/// `short_limit`. The eight short rays that are cast together are taken from different regions, so
/// that they do not write to the same cache lines.
void collect_rays(const RaySource& source, BlockShare share, std::int64_t short_limit, Rays& rays);

/// A box around every voxel that will be visited, relative to the sensor's voxel.
struct RayBounds {
  std::array<std::int32_t, 3> low{0, 0, 0}, high{0, 0, 0};
};
RayBounds bounds_of(const RaySource& source);

/// Reusable memory of the ray caster: one dense bit window around the sensor per thread, of which
/// only the touched pages are ever resident, and the rays.
struct RaycastScratch {
  std::vector<RayWindow> windows;
  std::vector<Rays> rays;  ///< per thread

  std::size_t memory_bytes() const;
};

/// Returns P'_obs (paper, III): the voxels q on Bresenham's lines from the sensor's voxel s to
/// every measured voxel v, as far as |(s - q) Delta|^2 <= max_range^2. With d = |v - s| per axis, M
/// = max(d) and an error e = M / 2 per axis, a line has M + 1 voxels; after each of them, per axis:
///   e -= d;  if (e < 0) { e += M; q moves by one towards v; }
/// Below, the same in closed form (Line), eight lines at a time. `max_range_m / voxel_size_m` must
/// not exceed kMaxRangeVoxels. Each source has a sensor of its own; their voxels are united.
VoxelList raycast(std::span<const RaySource> sources, RaycastScratch& scratch, ThreadPool& pool);

/// Returns the sources of a scan: one for each place that its rays start at.
std::vector<RaySource> ray_sources(const VoxelizedScan& scan, double voxel_size_m,
                                   double max_range_m);

/// Longest range in voxels; the window around it must stay addressable.
inline constexpr double kMaxRangeVoxels = 1500;

}  // namespace mosbench
