#pragma once

#include <cstdint>
#include <vector>

#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// algorithm step 5h: kMovingLabel for points in a voxel of `moving`, kStaticLabel for all others.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving);

/// S of every point's voxel (algorithm step 5c); 0 where the scan has no voxel or the field none.
std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums);

}  // namespace mosbench::hmm_mos
