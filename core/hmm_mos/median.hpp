#pragma once

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// algorithm step 5b: the median of the unfiltered scores of each occupied voxel and its up to 26
/// occupied neighbours; of an even number the mean of the two middle ones, truncated.
ScoreField median_filter(const VoxelizedScan& scan, const ScoreField& scores, ThreadPool& pool);

}  // namespace mosbench::hmm_mos
