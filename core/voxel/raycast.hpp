#pragma once

#include <cstddef>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/ray_window.hpp"
#include "core/voxel/rays.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench {

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
/// not exceed kMaxRangeVoxels.
VoxelList raycast(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                  double max_range_m, RaycastScratch& scratch, ThreadPool& pool);

/// Longest range in voxels; the window around it must stay addressable.
inline constexpr double kMaxRangeVoxels = 1500;

}  // namespace mosbench
