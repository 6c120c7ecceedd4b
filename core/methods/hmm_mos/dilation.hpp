#pragma once

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Nearest-neighbour dilation (paper, III): returns the occupied voxels of the scan among the 27
/// around each voxel of `dynamic`.
VoxelSet dilate_occupied(const VoxelizedScan& scan, const VoxelSet& dynamic, ThreadPool& pool);

}  // namespace mosbench::hmm_mos
