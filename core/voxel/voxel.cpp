#include "core/voxel/voxel.hpp"

#include <cmath>

namespace mosbench {

BlockMask within_range(const VoxelGrid& grid, const BlockIndex& block, const BlockMask& mask,
                       const Eigen::Vector3d& sensor_m, double range_m) {
  const Eigen::Vector3d low_m = grid.corner_m(voxel_at(block, 0)) - sensor_m;
  const double extent_m = (kBlockSide - 1) * grid.voxel_size_m;
  double nearest_sq_m2 = 0, farthest_sq_m2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = low_m[axis], high = low + extent_m;
    const double nearest = low > 0 ? low : (high < 0 ? high : 0.0);
    const double farthest = std::max(std::abs(low), std::abs(high));
    nearest_sq_m2 += nearest * nearest;
    farthest_sq_m2 += farthest * farthest;
  }
  const double range_sq_m2 = range_m * range_m;
  // Bounds are rounded differently from the voxels' own sums: near the limit each voxel is tested.
  if (farthest_sq_m2 < range_sq_m2 * (1 - 1e-9)) return mask;
  if (nearest_sq_m2 > range_sq_m2 * (1 + 1e-9)) return {};
  BlockMask inside;
  for_each_cell(mask, [&](std::uint32_t cell) {
    const Eigen::Vector3d offset_m = grid.corner_m(voxel_at(block, cell)) - sensor_m;
    const double distance_sq_m2 =
        (offset_m.x() * offset_m.x() + offset_m.y() * offset_m.y()) + offset_m.z() * offset_m.z();
    if (distance_sq_m2 <= range_sq_m2) inside.set(cell);
  });
  return inside;
}

}  // namespace mosbench
