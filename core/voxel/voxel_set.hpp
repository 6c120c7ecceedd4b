#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxel/voxel.hpp"

namespace mosbench {

inline constexpr std::uint32_t kNoSlot = ~std::uint32_t{0};

/// Hash table from block index to a slot number: open addressing, linear probing, 64-bit keys.
/// Block indices must lie within +-2^20 of the grid's origin.
class BlockTable {
 public:
  BlockTable() { rehash(64); }

  /// kNoSlot when the block is absent.
  std::uint32_t find(const BlockIndex& block) const {
    const std::uint64_t key = key_of(block);
    for (std::size_t i = home(key);; i = (i + 1) & mask_) {
      if (entries_[i].key == key) return entries_[i].slot;
      if (entries_[i].key == kEmpty) return kNoSlot;
    }
  }

  /// The slot of the block; `fresh` is stored and returned when it was absent.
  std::uint32_t find_or_insert(const BlockIndex& block, std::uint32_t fresh);
  /// Does nothing when the block is absent.
  void erase(const BlockIndex& block);
  /// Makes room for so many blocks.
  void reserve(std::size_t blocks);
  void clear();
  std::size_t size() const { return size_; }
  std::size_t memory_bytes() const { return entries_.capacity() * sizeof(Entry); }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t slot;
  };
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  static std::uint64_t key_of(const BlockIndex& block) {
    const auto biased = [](std::int32_t c) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(c + (1 << 20)));
    };
    return (biased(block.x) << 42) ^ (biased(block.y) << 21) ^ biased(block.z);
  }
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> shift_);
  }
  void rehash(std::size_t capacity);

  std::vector<Entry> entries_;
  std::size_t mask_ = 0;
  int shift_ = 0;
  std::size_t size_ = 0;
};

/// Voxels as a list of blocks without a table; the two arrays run together. No block comes twice.
struct VoxelList {
  std::vector<BlockIndex> blocks;
  std::vector<BlockMask> masks;
};

/// A set of voxels: a bit mask for each block that holds any. `blocks` and `masks` run together.
struct VoxelSet {
  std::vector<BlockIndex> blocks;
  std::vector<BlockMask> masks;
  BlockTable table;

  std::size_t block_count() const { return blocks.size(); }
  std::uint32_t find(const BlockIndex& block) const { return table.find(block); }
  /// The slot of the block, appended with an empty mask when absent.
  std::uint32_t insert(const BlockIndex& block);
  const BlockMask* mask_of(const BlockIndex& block) const {
    const std::uint32_t slot = find(block);
    return slot == kNoSlot ? nullptr : &masks[slot];
  }
  bool contains(const Voxel& v) const {
    const BlockMask* mask = mask_of(block_of(v));
    return mask != nullptr && mask->test(cell_of(v));
  }
  /// Makes room for so many blocks.
  void reserve(std::size_t block_count);
  void clear();
  std::size_t memory_bytes() const {
    return blocks.capacity() * sizeof(BlockIndex) + masks.capacity() * sizeof(BlockMask) +
           table.memory_bytes();
  }
};

/// Returns the voxels in either set.
VoxelSet united(VoxelSet some, const VoxelSet& more);

/// Returns the voxels in both sets.
VoxelSet in_both(const VoxelSet& some, const VoxelSet& others);

/// Calls visit(position 0..26, block) for a block and its 26 neighbours, x fastest; 13 is itself.
template <typename Visit>
void for_each_neighbour(const BlockIndex& block, Visit&& visit) {
  std::size_t position = 0;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        visit(position++, BlockIndex{block.x + dx, block.y + dy, block.z + dz});
      }
    }
  }
}

/// Masks of a block and its 26 neighbours in the order of for_each_neighbour; absent ones are null.
using Neighbourhood = std::array<const BlockMask*, 27>;

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
