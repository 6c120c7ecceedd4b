#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

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

}  // namespace mosbench
