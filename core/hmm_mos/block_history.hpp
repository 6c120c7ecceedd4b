#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/hmm_mos/hmm.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos {

/// How the voxels of a block came to their state: short counters that stop at their highest value,
/// one bit per voxel and digit, so that a few operations update the whole block.
class BlockHistory {
 public:
  /// Scans seen free before an arrival counts as sure.
  static constexpr int kSureScans = 3;
  /// Scans seen occupied until a voxel is settled.
  static constexpr int kSettledScans = 8;
  /// Ages are known up to this; older arrivals count as none.
  static constexpr std::uint32_t kMaxAgeScans = 100;

  /// Takes in the states of the voxels that scan k observed, before and after their filter step.
  /// Blocks are updated in the order of scans.
  void update(const BlockMask& observed, const BlockStates& before, const BlockStates& after,
              std::uint32_t scan_index);
  /// Makes voxels never seen.
  void forget(const BlockMask& voxels);

  /// Returns the voxels whose present run of occupied scans began from free, at most `scans` scans
  /// before `scan_index`.
  BlockMask arrived_within(std::uint32_t scans, std::uint32_t scan_index) const {
    return within(arrived_, scans, scan_index);
  }
  /// The same of those that were seen free in kSureScans scans or more.
  BlockMask sure_within(std::uint32_t scans, std::uint32_t scan_index) const {
    return within(sure_, scans, scan_index);
  }
  /// Returns the voxels that were seen occupied in kSettledScans scans or more of their present
  /// run.
  const BlockMask& settled() const { return settled_; }

  std::size_t memory_bytes() const {
    return sizeof(BlockHistory) + (arrived_at_ ? sizeof(*arrived_at_) : 0);
  }

 private:
  BlockMask within(const BlockMask& arrivals, std::uint32_t scans, std::uint32_t scan_index) const;

  BlockMask arrived_, sure_, settled_;
  BlockMask free_low_, free_high_;     // scans seen free, 0 to 3
  std::array<BlockMask, 3> occupied_;  // scans seen occupied, modulo 8
  std::uint32_t updated_ = 0;          // scan of the last update
  // Scan of the arrival modulo 256, valid where arrived; null while nothing ever arrived, as in
  // most blocks.
  std::unique_ptr<std::array<std::uint8_t, kBlockVoxels>> arrived_at_;
};

}  // namespace mosbench::hmm_mos
