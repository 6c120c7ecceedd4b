#include "core/voxel/source_grid.hpp"

#include <algorithm>

namespace mosbench {

SourceGrid::SourceGrid(std::span<const VoxelSet* const> sets, std::span<const BlockIndex> blocks,
                       int margin) {
  if (blocks.empty()) return;
  std::array<std::int32_t, 3> high{blocks[0].x, blocks[0].y, blocks[0].z};
  low_ = high;
  for (const BlockIndex& block : blocks) {
    const std::array<std::int32_t, 3> c{block.x, block.y, block.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], c[axis]);
      high[axis] = std::max(high[axis], c[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis] -= margin;
    high[axis] += margin;
    sides_[axis] = static_cast<std::size_t>(high[axis] - low_[axis] + 1);
  }
  slots_.assign(sides_[0] * sides_[1] * sides_[2], kEmpty);
  sources_.emplace_back();
  for (const VoxelSet* set : sets) {
    for (std::size_t i = 0; i < set->block_count(); ++i) {
      const BlockIndex& block = set->blocks[i];
      if (block.x < low_[0] || block.y < low_[1] || block.z < low_[2] || block.x > high[0] ||
          block.y > high[1] || block.z > high[2]) {
        continue;
      }
      std::uint32_t& slot = slots_[position(block)];
      if (slot == kEmpty) {
        slot = static_cast<std::uint32_t>(sources_.size());
        sources_.emplace_back();
      }
      sources_[slot].add(set->masks[i]);
    }
  }
}

}  // namespace mosbench
