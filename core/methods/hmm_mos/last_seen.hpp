#pragma once

#include <array>
#include <cstdint>

#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos {

/// The index of the scan in which each voxel of a block was seen last, modulo 2^planes: what w_g
/// (paper, III) is compared with. Bit p of all 512 numbers fills one mask, so that all numbers are
/// written or compared with a few operations per bit instead of some per voxel. The upper bits are
/// the same for eight scans and written after these.
class LastSeen {
 public:
  static constexpr int kMaxPlanes = 16;
  static constexpr int kLowPlanes = 3;  ///< written by every stamp
  /// Bytes from the beginning that most stamps touch.
  static constexpr std::size_t kTouchedBytes = (2 + kLowPlanes) * sizeof(BlockMask);
  /// Returns how many planes distinguish ages up to `max_age`.
  static int planes_for(std::uint32_t max_age);

  void stamp(const BlockMask& voxels, std::uint32_t scan_index, int planes);

  /// Ages at one scan, in the same form.
  class Ages {
   public:
    Ages(const LastSeen& last_seen, std::uint32_t scan_index, int planes);
    BlockMask at_least(std::uint32_t age) const;
    /// The greatest age among `voxels`; 0 when there is none.
    std::uint32_t greatest(const BlockMask& voxels) const;

   private:
    std::array<BlockMask, kMaxPlanes> bits_;
    int planes_;
  };

 private:
  std::uint32_t upper_ = 0;  ///< the scan index without its low bits, of the last stamp
  BlockMask recent_;         ///< stamped since that changed: their upper bits are not written yet
  std::array<BlockMask, kMaxPlanes> bits_;
};

}  // namespace mosbench::hmm_mos
