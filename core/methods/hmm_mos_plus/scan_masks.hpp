#pragma once

#include <cstdint>
#include <vector>

#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos_plus {

/// Voxels of a scan: masks in the order of scan.measured.blocks.
using ScanMasks = std::vector<BlockMask>;

/// Returns the slots of the masks that hold voxels.
inline std::vector<std::uint32_t> slots_with_any(const ScanMasks& masks) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < masks.size(); ++slot) {
    if (masks[slot].any()) slots.push_back(slot);
  }
  return slots;
}

}  // namespace mosbench::hmm_mos_plus
