#include "core/voxel/point_labels.hpp"

#include <mosbench/scan.hpp>

namespace mosbench {

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

}  // namespace mosbench
