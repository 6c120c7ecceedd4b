#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos_plus/block_history.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
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

/// The classes of a scan's occupied voxels by their history.
struct ArrivalClasses {
  ScanMasks
      seeds;  ///< arrived of late, apart from what is settled or was just left, in known space
  ScanMasks arrived;   ///< of late: those that are seeds where nothing firm is near
  ScanMasks fresh;     ///< arrived just now: among the seeds, a sign that an object still moves
  ScanMasks settled;   ///< there for longer: they connect nothing
  ScanMasks aged;      ///< there for some scans: most of an object that moves is not
  ScanMasks open;      ///< seen through straight above or below; online of what arrived alone
  ScanMasks standing;  ///< aged, did not arrive within half of object_age_s: not grown into

  std::size_t memory_bytes() const { return 7 * seeds.capacity() * sizeof(BlockMask); }
};

/// Returns the classes of scan k, with the map as it is after it.
ArrivalClasses classify(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                        ThreadPool& pool);

/// For a scan that is judged later, with the map as it is after scan k: its voxels that are free by
/// then departed. They arrived, are neither settled, aged nor standing, and are fresh seeds as far
/// as they pass a seed's tests but the one for what was just left.
void add_departures(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                    ThreadPool& pool, ArrivalClasses& classes);

}  // namespace mosbench::hmm_mos_plus
