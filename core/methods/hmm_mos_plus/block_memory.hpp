#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/methods/hmm_mos_plus/block_history.hpp"
#include "core/methods/hmm_mos_plus/tick_clock.hpp"

namespace mosbench::hmm_mos_plus {

/// Keeps how the voxels of a map came to their states.
class BlockMemory final : public hmm_mos::BlockObserver {
 public:
  /// `stamps_ns` of all scans, as TickClock takes them.
  explicit BlockMemory(std::span<const std::int64_t> stamps_ns = {}) : clock_(stamps_ns) {}

  void begin(std::uint32_t scan_index) override { tick_ = clock_.of(scan_index); }
  void added(std::uint32_t slot, std::size_t slot_count) override {
    if (histories_.size() < slot_count) histories_.resize(slot_count);
    histories_[slot] = {};
  }
  void fetch(std::uint32_t slot) const override {
    hmm_mos::fetch(&histories_[slot], BlockHistory::kTouchedBytes);
  }
  void updated(std::uint32_t slot, const BlockMask& observed, const hmm_mos::BlockStates& before,
               const hmm_mos::BlockStates& after) override {
    histories_[slot].update(observed, before, after, tick_);
  }
  void forgotten(std::uint32_t slot, const BlockMask& voxels) override {
    histories_[slot].forget(voxels);
  }

  const BlockHistory& history(std::uint32_t slot) const { return histories_[slot]; }
  const Tick& tick() const { return tick_; }
  std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const BlockHistory& history : histories_) bytes += history.memory_bytes();
    return bytes;
  }

 private:
  TickClock clock_;
  Tick tick_;                           // of the last update
  std::deque<BlockHistory> histories_;  // by slot of the block
};

/// A map after scan k, with what is remembered of its blocks.
struct RememberedMap {
  hmm_mos::VoxelMap& map;
  const BlockMemory& memory;
  std::uint32_t k;

  /// The states of a block's known voxels, and how all its voxels came to theirs.
  struct Past {
    hmm_mos::BlockStates known;
    const BlockHistory& history;
    std::uint32_t tick;  ///< of the last update
  };
  /// Returns nullopt where there is no block.
  std::optional<Past> past_at(const BlockIndex& index) const {
    const auto block = map.block_at(k, index);
    if (!block) return std::nullopt;
    return Past{block->known, memory.history(block->slot), memory.tick().at};
  }
};

}  // namespace mosbench::hmm_mos_plus
