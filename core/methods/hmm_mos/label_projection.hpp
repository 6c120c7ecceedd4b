#pragma once

#include <cstdint>
#include <vector>

#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns a label per point (paper, III: points take the label of their voxel): kMovingLabel in
/// voxels of `moving`, kStaticLabel elsewhere.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving);

/// Returns L^dyn of every point's voxel; 0 where the point has no voxel or the voxel no score.
std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums);

}  // namespace mosbench::hmm_mos
