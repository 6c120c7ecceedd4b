#pragma once

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns, for each occupied voxel, the median of the votes of itself and its up to 26 occupied
/// neighbours; of an even number the mean of the two middle ones, truncated. A step of the authors'
/// program that the paper's section III does not mention.
VoteField median_filter(const VoxelizedScan& scan, const VoteField& votes, ThreadPool& pool);

}  // namespace mosbench::hmm_mos
