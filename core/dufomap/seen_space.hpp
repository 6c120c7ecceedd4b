#pragma once

#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/dufomap/config.hpp"
#include "core/voxel/ray_window.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dufomap {

/// What one scan saw.
struct SeenSpace {
  VoxelSet crossed;  ///< by rays, the voxels where they end and d_p more included
  VoxelSet hit;      ///< the last d_s of the rays to voxels within max_range
};

/// Reusable memory of `see`: windows of bits around the sensor.
struct SightScratch {
  RayWindow hits;
  std::vector<RayWindow> crossed;  ///< per thread

  std::size_t memory_bytes() const;
};

/// Casts a ray to the centre of every measured voxel, as UFOMap does for DUFOMap
/// (ray_passthrough_hits = false, inflate_unknown_compensation = true): hits first, the last d_s of
/// each ray. Then each ray crosses voxels from the sensor on, up to the first hit one, its end or
/// max_range, and goes on until it has moved d_p voxels along one axis, so that voxels before a
/// surface have seen neighbours behind it.
SeenSpace see(const VoxelizedScan& scan, const VoxelGrid& grid, const Config& config,
              SightScratch& scratch, ThreadPool& pool);

/// Returns the void voxels: crossed ones that were not hit and whose neighbours within d_p were all
/// crossed or hit (paper, section III-B).
VoxelList void_of(const SeenSpace& seen, int pose_error_voxels, ThreadPool& pool);

}  // namespace mosbench::dufomap
