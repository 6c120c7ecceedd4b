#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "core/methods/hmm_mos/hmm.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::hmm_mos {

/// Returns P'_chg (paper, III): voxels whose state S went from free to occupied or back; becoming
/// known for the first time is no change.
inline BlockMask detect_changes(const BlockStates& before, const BlockStates& after) {
  return (before.free & after.occupied) | (before.occupied & after.free);
}

/// P'_chg (paper, III) of the last n + 1 scans.
class ChangeLog {
 public:
  explicit ChangeLog(std::size_t scans) : scans_(scans) {}

  void add(std::uint32_t scan_index, VoxelList changed);

  /// Returns the voxels whose last change is at `first_scan` or later.
  VoxelSet since(std::uint32_t first_scan) const;

  /// Removes voxels of a block: a new record of theirs starts as "never changed".
  void forget(const BlockIndex& block, const BlockMask& voxels);

  /// Of changes at `last_scan` or earlier, keeps the voxels in kept(block).
  template <typename Kept>
  void keep_until(std::uint32_t last_scan, Kept&& kept) {
    for (Entry& entry : entries_) {
      if (entry.scan_index > last_scan) return;
      for (std::size_t i = 0; i < entry.voxels.blocks.size(); ++i) {
        BlockMask& mask = entry.voxels.masks[i];
        mask = mask & kept(entry.voxels.blocks[i]);
      }
    }
  }

 private:
  struct Entry {
    std::uint32_t scan_index;
    VoxelList voxels;
  };
  std::size_t scans_;
  std::deque<Entry> entries_;  // oldest first
};

}  // namespace mosbench::hmm_mos
