#include "core/methods/hmm_mos/dilation.hpp"

#include <vector>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {

VoxelSet dilate_occupied(const VoxelizedScan& scan, const VoxelSet& dynamic, ThreadPool& pool) {
  const std::vector<std::uint32_t> slots = slots_within(scan, dynamic, 1);
  std::vector<BlockMask> dilated(slots.size());
  for_each_block_near(
      dynamic, 1, scan, slots, pool,
      [&](std::size_t i, const HaloRows&, const BlockMask& reach) { dilated[i] = reach; });
  return set_of(scan, slots, dilated);
}

}  // namespace mosbench::hmm_mos
