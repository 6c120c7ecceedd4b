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

/// algorithm step 2: the voxels on the integer lines from the sensor's voxel to every measured
/// voxel, as far as |(s - q) Delta|^2 <= max_range^2. `max_range_m / voxel_size_m` must not exceed
/// kMaxRangeVoxels.
VoxelList raycast(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                  double max_range_m, RaycastScratch& scratch, ThreadPool& pool);

/// Longest range in voxels; the window around it must stay addressable.
inline constexpr double kMaxRangeVoxels = 1500;

}  // namespace mosbench
