#pragma once

#include <cstdint>

#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos_plus/block_history.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/scan_masks.hpp"

namespace mosbench::hmm_mos_plus {

/// The classes of a scan's occupied voxels by their history.
struct ArrivalClasses {
  ScanMasks
      seeds;  ///< arrived of late, apart from what is settled or was just left, in known space
  ScanMasks fresh;     ///< arrived just now: among the seeds, a sign that an object still moves
  ScanMasks settled;   ///< there for longer: they connect nothing
  ScanMasks aged;      ///< there for some scans: most of an object that moves is not
  ScanMasks standing;  ///< aged, did not arrive within half of object_age_s: not grown into

  std::size_t memory_bytes() const { return 5 * seeds.capacity() * sizeof(BlockMask); }
};

/// Returns the classes of scan k, with the map as it is after it.
ArrivalClasses classify(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                        ThreadPool& pool);

/// For a scan that is judged later, with the map as it is after scan k: its voxels that are free by
/// then departed. They are neither settled, aged nor standing, and fresh seeds as far as they pass
/// a seed's tests but the one for what was just left.
void add_departures(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                    ThreadPool& pool, ArrivalClasses& classes);

}  // namespace mosbench::hmm_mos_plus
