#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/methods/hmm_mos/hmm.hpp"
#include "core/methods/hmm_mos_plus/tick_clock.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos_plus {

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

}  // namespace mosbench::hmm_mos_plus
