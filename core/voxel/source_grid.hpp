#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel/distance_field.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// The union of voxel sets over a box of blocks, addressed without hashing.
class SourceGrid {
 public:
  /// The box spans `blocks` and `margin` blocks around them; voxels outside of it are left out.
  SourceGrid(std::span<const VoxelSet* const> sets, std::span<const BlockIndex> blocks, int margin);

  /// Whether any of the (2 reach + 1)^3 blocks around holds a voxel.
  bool any_around(const BlockIndex& block, int reach) const {
    const auto width = static_cast<std::size_t>(2 * reach + 1);
    for (int dz = -reach; dz <= reach; ++dz) {
      for (int dy = -reach; dy <= reach; ++dy) {
        const std::size_t first = position({block.x - reach, block.y + dy, block.z + dz});
        for (std::size_t i = 0; i < width; ++i) {
          if (slots_[first + i] != kEmpty) return true;
        }
      }
    }
    return false;
  }

  /// Finds the (2 reach + 1)^3 blocks around, x fastest. The block must lie in the box.
  void neighbours(const BlockIndex& block, int reach, std::span<const SourceBlock*> around) const {
    const auto width = static_cast<std::size_t>(2 * reach + 1);
    std::size_t i = 0;
    for (int dz = -reach; dz <= reach; ++dz) {
      for (int dy = -reach; dy <= reach; ++dy) {
        const std::size_t first = position({block.x - reach, block.y + dy, block.z + dz});
        for (std::size_t dx = 0; dx < width; ++dx) around[i++] = &sources_[slots_[first + dx]];
      }
    }
  }

 private:
  static constexpr std::uint32_t kEmpty = 0;  // the slot of a block without voxels

  std::size_t position(const BlockIndex& block) const {
    return (static_cast<std::size_t>(block.z - low_[2]) * sides_[1] +
            static_cast<std::size_t>(block.y - low_[1])) *
               sides_[0] +
           static_cast<std::size_t>(block.x - low_[0]);
  }

  std::array<std::int32_t, 3> low_{};
  std::array<std::size_t, 3> sides_{};
  std::vector<std::uint32_t> slots_;
  std::vector<SourceBlock> sources_;
};

}  // namespace mosbench
