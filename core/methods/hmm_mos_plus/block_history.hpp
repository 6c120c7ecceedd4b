#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/methods/hmm_mos/hmm.hpp"
#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos_plus {

/// When a scan was measured, in tenths of a second, so that histories of 5 and of 20 Hz are like
/// those of 10 Hz.
struct Tick {
  std::uint32_t at = 0;       ///< since the first scan; wraps around
  std::uint32_t steps = 1;    ///< since the scan before
  std::uint32_t periods = 1;  ///< since the scan before, in scans, missing ones counted
  double period_s = 0.1;      ///< of the scans
};

/// Gives each scan its tick. The period is the median distance of the stamps, and 0.08 to 0.125 s
/// count as 0.1 s: jitter changes nothing, a scan that is missing counts as if it had been there.
class TickClock {
 public:
  static constexpr double kSeconds = 0.1;

  /// `stamps_ns` of all scans; without any, and behind the last, scans are 0.1 s apart.
  explicit TickClock(std::span<const std::int64_t> stamps_ns);

  Tick of(std::uint32_t scan_index) const;

 private:
  std::vector<Tick> ticks_;
};

/// How the voxels of a block came to their state: short counters that stop at their highest value,
/// one bit per voxel and digit, so that a few operations update the whole block. They count a scan
/// that finds a voxel in another state than before as 1 and others by the ticks since the scan
/// before: at 10 Hz, scans.
class BlockHistory {
 public:
  /// Count of being free from which an arrival is sure.
  static constexpr std::uint32_t kSureTicks = 3;
  /// A voxel occupied again within this time is no sure arrival.
  static constexpr std::uint32_t kReturnTicks = 10;
  /// Count of being occupied from which a voxel is aged.
  static constexpr std::uint32_t kAgedTicks = 5;
  /// The same from which it is settled.
  static constexpr std::uint32_t kSettledTicks = 8;
  /// Ages are known up to this; older arrivals count as none.
  static constexpr std::uint32_t kMaxAgeTicks = 100;

  /// Takes in the states of the voxels that a scan observed, before and after their filter step.
  /// Blocks are updated in the order of scans.
  void update(const BlockMask& observed, const hmm_mos::BlockStates& before,
              const hmm_mos::BlockStates& after, const Tick& tick);
  /// Makes voxels never seen.
  void forget(const BlockMask& voxels);

  /// Returns those of some voxels whose present run of occupied scans began from free, at most
  /// `ticks` before `now`; up to kMaxAgeTicks.
  BlockMask arrived_within(const BlockMask& voxels, std::uint32_t ticks, std::uint32_t now) const {
    return within(voxels & arrived_, ticks, now);
  }
  /// The same of those that were free for kSureTicks or more and not left in the last kReturnTicks.
  BlockMask sure_within(const BlockMask& voxels, std::uint32_t ticks, std::uint32_t now) const {
    return within(voxels & sure_, ticks, now);
  }
  /// Returns those of some voxels that are free and were occupied until at most `ticks` before
  /// `now`.
  BlockMask left_within(const BlockMask& voxels, std::uint32_t ticks, std::uint32_t now) const {
    return within(voxels & left_, ticks, now);
  }
  /// Returns the voxels that were occupied for kSettledTicks or more in their present run.
  const BlockMask& settled() const { return settled_; }
  /// The same of kAgedTicks.
  BlockMask aged() const { return settled_ | (occupied_[2] & (occupied_[1] | occupied_[0])); }

  /// Bytes from the start that `update` needs where all that is seen is free.
  static constexpr std::size_t kTouchedBytes = 2 * sizeof(std::uint64_t) + 4 * sizeof(BlockMask);

  std::size_t memory_bytes() const {
    return sizeof(BlockHistory) + (turned_at_ ? sizeof(*turned_at_) : 0);
  }

 private:
  BlockMask within(const BlockMask& turned, std::uint32_t ticks, std::uint32_t now) const;
  void turn(const BlockMask& voxels, std::uint32_t now);
  void count_occupied(const BlockMask& voxels);
  void count_free(const BlockMask& voxels);

  std::uint32_t updated_ = 0;  // tick of the last update
  std::uint32_t pruned_ = 0;   // tick at which no turn was older than kMaxAgeTicks
  // Tick of the turn modulo 256, valid where arrived or left; null while nothing ever turned, as in
  // most blocks.
  std::unique_ptr<std::array<std::uint8_t, kBlockVoxels>> turned_at_;
  BlockMask arrived_, left_;        // turned from free to occupied, and back
  BlockMask free_low_, free_high_;  // count of being free, 0 to 3; so far what free space touches
  BlockMask sure_, settled_;
  std::array<BlockMask, 3> occupied_;  // count of being occupied, modulo 8
};

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
    BlockMask observed;  ///< by scan k
    const BlockHistory& history;
    std::uint32_t tick;  ///< of the last update
  };
  /// Returns nullopt where there is no block.
  std::optional<Past> past_at(const BlockIndex& index) const {
    const auto block = map.block_at(k, index);
    if (!block) return std::nullopt;
    return Past{block->known, block->observed, memory.history(block->slot), memory.tick().at};
  }
};

}  // namespace mosbench::hmm_mos_plus
