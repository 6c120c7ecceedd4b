#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel/voxelize.hpp"

namespace mosbench {

/// Returns a label per point (paper, III: points take the label of their voxel): kMovingLabel in
/// voxels of `moving`, masks in the order of scan.measured.blocks, kStaticLabel elsewhere.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan,
                                          std::span<const BlockMask> moving);

/// Returns the score of every point's voxel, 0 where the point has no voxel.
/// `score_of(slot, cell)` is that of a cell of scan.measured.blocks[slot].
template <typename ScoreOf>
std::vector<float> project_scores(const VoxelizedScan& scan, ScoreOf&& score_of) {
  std::vector<float> scores(scan.voxel_of_point.size(), 0);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel != kNoVoxel) scores[i] = score_of(voxel / kBlockVoxels, voxel % kBlockVoxels);
  }
  return scores;
}

}  // namespace mosbench
