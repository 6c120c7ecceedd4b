#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// Slots of one type that are taken and returned without moving the others.
template <typename Value>
class SlotPool {
 public:
  Value& operator[](std::uint32_t slot) { return chunks_[slot / kChunk][slot % kChunk]; }
  const Value& operator[](std::uint32_t slot) const {
    return chunks_[slot / kChunk][slot % kChunk];
  }

  /// Returns a free slot; its content is left over from its last use.
  std::uint32_t take() {
    if (free_.empty()) {
      const auto first = static_cast<std::uint32_t>(chunks_.size()) * kChunk;
      chunks_.push_back(std::make_unique_for_overwrite<Value[]>(kChunk));
      for (std::uint32_t i = kChunk; i-- > 0;) free_.push_back(first + i);
    }
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    return slot;
  }
  void give_back(std::uint32_t slot) { free_.push_back(slot); }

  /// Slots ever made; every slot number is below.
  std::uint32_t capacity() const { return static_cast<std::uint32_t>(chunks_.size()) * kChunk; }
  std::size_t in_use() const { return capacity() - free_.size(); }
  std::size_t memory_bytes() const { return capacity() * sizeof(Value); }

 private:
  static constexpr std::uint32_t kChunk = 256;
  std::vector<std::unique_ptr<Value[]>> chunks_;
  std::vector<std::uint32_t> free_;
};

/// Blocks of one type by their index, in slots that never move.
template <typename Block>
class BlockMap {
 public:
  /// kNoSlot when the block is absent.
  std::uint32_t find(const BlockIndex& index) const { return table_.find(index); }

  /// Returns the slot of the block, and whether it was added just now: then its content is left
  /// over from an earlier block.
  std::pair<std::uint32_t, bool> find_or_add(const BlockIndex& index) {
    if (const std::uint32_t slot = table_.find(index); slot != kNoSlot) return {slot, false};
    const std::uint32_t slot = blocks_.take();
    table_.find_or_insert(index, slot);
    if (entries_.size() < blocks_.capacity()) entries_.resize(blocks_.capacity());
    entries_[slot] = {index, true};
    return {slot, true};
  }

  void erase(std::uint32_t slot) {
    table_.erase(entries_[slot].index);
    entries_[slot].live = false;
    blocks_.give_back(slot);
  }

  Block& operator[](std::uint32_t slot) { return blocks_[slot]; }
  const Block& operator[](std::uint32_t slot) const { return blocks_[slot]; }
  const BlockIndex& index_of(std::uint32_t slot) const { return entries_[slot].index; }

  /// Calls visit(slot) for the blocks in slots first, first + stride, ...; it may erase that block.
  template <typename Visit>
  void for_each_slot(Visit&& visit, std::uint32_t first = 0, std::uint32_t stride = 1) const {
    for (std::uint32_t slot = first; slot < entries_.size(); slot += stride) {
      if (entries_[slot].live) visit(slot);
    }
  }

  std::size_t size() const { return blocks_.in_use(); }
  /// Every slot is below.
  std::uint32_t slot_count() const { return blocks_.capacity(); }
  std::size_t memory_bytes() const {
    return table_.memory_bytes() + blocks_.memory_bytes() + entries_.capacity() * sizeof(Entry);
  }

 private:
  /// Apart from the blocks, so that a sweep over the slots does not fetch these.
  struct Entry {
    BlockIndex index;
    bool live = false;
  };

  BlockTable table_;
  SlotPool<Block> blocks_;
  std::vector<Entry> entries_;
};

}  // namespace mosbench
