#include "core/methods/hmm_mos/label_projection.hpp"

#include <mosbench/scan.hpp>

#include "core/voxel/point_labels.hpp"

namespace mosbench::hmm_mos {

std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving) {
  if (moving.block_count() == 0) {
    return std::vector<std::uint32_t>(scan.voxel_of_point.size(), kStaticLabel);
  }
  std::vector<BlockMask> masks(scan.measured.block_count());
  for (std::size_t i = 0; i < moving.block_count(); ++i) {
    masks[scan.measured.find(moving.blocks[i])] = moving.masks[i];
  }
  return mosbench::project_labels(scan, masks);
}

std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums) {
  std::vector<const SumField::Block*> values;
  for (const BlockIndex& block : scan.measured.blocks) values.push_back(sums.find(block));
  return mosbench::project_scores(scan, [&](std::uint32_t slot, std::uint32_t cell) {
    return values[slot] == nullptr ? 0.0F : static_cast<float>((*values[slot])[cell]);
  });
}

}  // namespace mosbench::hmm_mos
