#include "core/methods/hmm_mos/change_detection.hpp"

#include <utility>

namespace mosbench::hmm_mos {

void ChangeLog::add(std::uint32_t scan_index, VoxelList changed) {
  entries_.push_back({scan_index, std::move(changed)});
  while (entries_.size() > scans_) entries_.pop_front();
}

VoxelSet ChangeLog::since(std::uint32_t first_scan) const {
  VoxelSet changed;
  for (const Entry& entry : entries_) {
    if (entry.scan_index < first_scan) continue;
    for (std::size_t i = 0; i < entry.voxels.blocks.size(); ++i) {
      BlockMask& mask = changed.masks[changed.insert(entry.voxels.blocks[i])];
      mask = mask | entry.voxels.masks[i];
    }
  }
  return changed;
}

void ChangeLog::forget(const BlockIndex& block, const BlockMask& voxels) {
  for (Entry& entry : entries_) {
    for (std::size_t i = 0; i < entry.voxels.blocks.size(); ++i) {
      if (!(entry.voxels.blocks[i] == block)) continue;
      entry.voxels.masks[i] = without(entry.voxels.masks[i], voxels);
    }
  }
}

}  // namespace mosbench::hmm_mos
