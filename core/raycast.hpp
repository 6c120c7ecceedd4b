#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/thread_pool.hpp"
#include "core/voxel_set.hpp"

namespace mosbench {

/// Blocks with any observed voxel; the two arrays run together. No block comes twice.
struct ObservedVoxels {
  std::vector<BlockIndex> blocks;
  std::vector<BlockMask> masks;
};

/// Reusable memory of the ray caster: one dense bit window around the sensor per thread, of which
/// only the touched pages are ever resident, and the rays.
class RaycastScratch {
 public:
  struct Window;
  struct Ray;
  RaycastScratch();
  ~RaycastScratch();
  RaycastScratch(RaycastScratch&&) noexcept;
  RaycastScratch& operator=(RaycastScratch&&) noexcept;

  /// Voxels visited by the rays of the last scan, each ray's own.
  std::size_t steps() const;
  /// Resident bytes: of the windows only what rays ever touched.
  std::size_t memory_bytes() const;

  std::vector<Window> windows;
  std::vector<Ray> rays, sorted_rays;
};

/// algorithm step 2: the voxels on the integer lines from the sensor's voxel to every measured
/// voxel, as far as |(s - q) Delta|^2 <= max_range^2. `max_range_m / voxel_size_m` must not exceed
/// kMaxRangeVoxels.
ObservedVoxels raycast(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                       double max_range_m, RaycastScratch& scratch, ThreadPool& pool);

/// Longest range in voxels; the window around it must stay addressable.
inline constexpr double kMaxRangeVoxels = 1500;

}  // namespace mosbench
