#include "core/voxel/voxel_set.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace mosbench {

std::uint32_t BlockTable::find_or_insert(const BlockIndex& block, std::uint32_t fresh) {
  const std::uint64_t key = key_of(block);
  std::size_t i = home(key);
  for (; entries_[i].key != kEmpty; i = (i + 1) & mask_) {
    if (entries_[i].key == key) return entries_[i].slot;
  }
  entries_[i] = {key, fresh};
  if (++size_ * 2 > entries_.size()) rehash(entries_.size() * 2);
  return fresh;
}

void BlockTable::erase(const BlockIndex& block) {
  const std::uint64_t key = key_of(block);
  std::size_t hole = home(key);
  for (; entries_[hole].key != key; hole = (hole + 1) & mask_) {
    if (entries_[hole].key == kEmpty) return;
  }
  // Backward-shift deletion: pull up every later entry of the run whose home does not lie behind
  // the hole.
  for (std::size_t i = (hole + 1) & mask_; entries_[i].key != kEmpty; i = (i + 1) & mask_) {
    if (((i - home(entries_[i].key)) & mask_) >= ((i - hole) & mask_)) {
      entries_[hole] = entries_[i];
      hole = i;
    }
  }
  entries_[hole].key = kEmpty;
  --size_;
}

void BlockTable::reserve(std::size_t blocks) {
  const std::size_t capacity = std::bit_ceil(2 * blocks + 1);
  if (capacity > entries_.size()) rehash(capacity);
}

void BlockTable::clear() {
  if (size_ == 0) return;
  std::fill(entries_.begin(), entries_.end(), Entry{kEmpty, kNoSlot});
  size_ = 0;
}

void BlockTable::rehash(std::size_t capacity) {
  std::vector<Entry> old = std::exchange(entries_, std::vector<Entry>(capacity, {kEmpty, kNoSlot}));
  mask_ = capacity - 1;
  shift_ = 64 - std::countr_zero(capacity);
  for (const Entry& entry : old) {
    if (entry.key == kEmpty) continue;
    std::size_t i = home(entry.key);
    while (entries_[i].key != kEmpty) i = (i + 1) & mask_;
    entries_[i] = entry;
  }
}

std::uint32_t VoxelSet::insert(const BlockIndex& block) {
  const auto fresh = static_cast<std::uint32_t>(blocks.size());
  const std::uint32_t slot = table.find_or_insert(block, fresh);
  if (slot == fresh) {
    blocks.push_back(block);
    masks.emplace_back();
  }
  return slot;
}

void VoxelSet::reserve(std::size_t block_count) {
  blocks.reserve(block_count);
  masks.reserve(block_count);
  table.reserve(block_count);
}

void VoxelSet::clear() {
  blocks.clear();
  masks.clear();
  table.clear();
}

VoxelSet united(VoxelSet some, const VoxelSet& more) {
  for (std::size_t i = 0; i < more.block_count(); ++i) {
    BlockMask& mask = some.masks[some.insert(more.blocks[i])];
    mask = mask | more.masks[i];
  }
  return some;
}

VoxelSet in_both(const VoxelSet& some, const VoxelSet& others) {
  VoxelSet both;
  for (std::size_t i = 0; i < some.block_count(); ++i) {
    const BlockMask* other = others.mask_of(some.blocks[i]);
    if (other == nullptr) continue;
    const BlockMask mask = some.masks[i] & *other;
    if (mask.any()) both.masks[both.insert(some.blocks[i])] = mask;
  }
  return both;
}

}  // namespace mosbench
