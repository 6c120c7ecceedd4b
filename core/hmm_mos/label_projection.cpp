#include "core/hmm_mos/label_projection.hpp"

#include <mosbench/scan.hpp>

namespace mosbench::hmm_mos {

std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving) {
  if (moving.block_count() == 0) {
    return std::vector<std::uint32_t>(scan.voxel_of_point.size(), kStaticLabel);
  }
  std::vector<BlockMask> masks(scan.measured.block_count());
  for (std::size_t i = 0; i < moving.block_count(); ++i) {
    masks[scan.measured.find(moving.blocks[i])] = moving.masks[i];
  }
  return project_labels(scan, masks);
}

std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan,
                                          std::span<const BlockMask> moving) {
  std::vector<std::uint32_t> labels(scan.voxel_of_point.size(), kStaticLabel);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    if (moving[voxel / kBlockVoxels].test(voxel % kBlockVoxels)) labels[i] = kMovingLabel;
  }
  return labels;
}

std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums) {
  std::vector<float> scores(scan.voxel_of_point.size(), 0);
  std::vector<const SumField::Block*> values;
  for (const BlockIndex& block : scan.measured.blocks) values.push_back(sums.find(block));
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel || values[voxel / kBlockVoxels] == nullptr) continue;
    scores[i] = static_cast<float>((*values[voxel / kBlockVoxels])[voxel % kBlockVoxels]);
  }
  return scores;
}

}  // namespace mosbench::hmm_mos
