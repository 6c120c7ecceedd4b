#pragma once

#include <span>
#include <vector>

#include "core/tsdf/tsdf_map.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::lc_free_space {

/// Returns, by block of the scan's measured voxels, those that the map has observed and does not
/// hold near a surface.
std::vector<BlockMask> in_free_space(const VoxelSet& measured, const tsdf::TsdfMap& map);

/// Adds the measured voxels that share a face with a seed. Dynablox's clusters without their least
/// size hold the same voxels: those that are no seeds are not grown from.
std::vector<BlockMask> grown(const VoxelSet& measured, std::span<const BlockMask> seeds);

}  // namespace mosbench::lc_free_space
