#pragma once

#include <array>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/methods/dufomap/config.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/ray_window.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dufomap {

/// The space that one scan saw. `passed` runs together with `known.blocks`.
struct SeenSpace {
  VoxelSet known;                 ///< crossed by rays, d_p more than their ends included, or hit
  std::vector<BlockMask> passed;  ///< those that no ray hit with its last d_s
};

/// Reusable memory of `see`: windows of bits around the sensor, those with an odd number in bytes
/// along y.
struct SightScratch {
  std::array<RayWindow, 2> hits;   ///< the same bits twice
  std::vector<RayWindow> crossed;  ///< two per thread

  std::size_t memory_bytes() const;
};

/// Casts a ray to the centre of every measured voxel, as UFOMap does for DUFOMap
/// (ray_passthrough_hits = false, inflate_unknown_compensation = true). Hits come first: the last
/// d_s of each ray. Then each ray crosses voxels from the sensor to the first hit one, its end or
/// max_range. It goes on until it has moved d_p voxels along one axis, so that voxels before a
/// surface have seen neighbours behind it.
SeenSpace see(const VoxelizedScan& scan, const VoxelGrid& grid, const Config& config,
              SightScratch& scratch, ThreadPool& pool);

/// Returns the void voxels that are not in `ever_void`: passed ones whose neighbours within d_p are
/// all known (paper, section III-B).
VoxelList new_voids(const SeenSpace& seen, const BlockMap<BlockMask>& ever_void,
                    int pose_error_voxels, ThreadPool& pool);

}  // namespace mosbench::dufomap
