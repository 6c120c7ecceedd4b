#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/methods/octomap/config.hpp"
#include "core/voxel/exact_rays.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::octomap {

/// The changes that one scan makes to the map.
struct ScanUpdate {
  VoxelSet hit;                               ///< end voxels of points within the range limit
  VoxelList free;                             ///< voxels on the rays, some of them hit
  std::vector<std::uint32_t> voxel_of_point;  ///< slot in `hit` * 512 + cell, or kNoVoxel
};

/// Finds what OctoMap's computeUpdate finds, rounded as there: points in single precision, counted
/// from the grid's origin. Points at or within min_range, and those that are not finite, are left
/// out.
ScanUpdate update_of(const PosedScan& scan, const VoxelGrid& grid, const Config& config,
                     std::vector<RayWindow>& windows, ThreadPool& pool);

}  // namespace mosbench::octomap
