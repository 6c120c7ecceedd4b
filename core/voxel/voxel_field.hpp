#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// A number per voxel for the blocks that have any but zero.
template <typename Value>
struct SparseField {
  using Block = std::array<Value, kBlockVoxels>;
  std::vector<BlockIndex> blocks;
  std::vector<Block> values;
  BlockTable table;

  /// Null where every value is zero.
  const Block* find(const BlockIndex& block) const {
    const std::uint32_t slot = table.find(block);
    return slot == kNoSlot ? nullptr : &values[slot];
  }
  /// The block must be absent.
  void add(const BlockIndex& block, const Block& block_values) {
    table.find_or_insert(block, static_cast<std::uint32_t>(blocks.size()));
    blocks.push_back(block);
    values.push_back(block_values);
  }
};

/// Votes for a voxel, at most m^3 = 3375.
using VoteField = SparseField<std::int16_t>;
/// Their sums over the local window.
using SumField = SparseField<std::int32_t>;

}  // namespace mosbench
