#pragma once

#include <cstddef>
#include <vector>

#include "core/hmm_mos_plus/arrivals.hpp"
#include "core/hmm_mos_plus/config.hpp"
#include "core/hmm_mos_plus/ground.hpp"
#include "core/hmm_mos_plus/scan_masks.hpp"

namespace mosbench::hmm_mos_plus {

/// Connected voxels of a scan that hold a seed; the numbers are those of VoxelizedScan.
struct Component {
  std::vector<std::uint32_t> voxels;
  double seed_share = 0;  ///< seeds / voxels
  bool moves = false;     ///< enough seeds, some of them fresh, of an object's age and size
};

/// Returns the components (26 neighbours) of the seeds and `others` that hold a seed.
std::vector<Component> components_of(const VoxelizedScan& scan, const ArrivalClasses& classes,
                                     const ScanMasks& others, const Ground& ground,
                                     const Config& config);

/// Returns those of the occupied voxels `low` that lie under one of the objects' voxels, straight
/// or diagonally.
ScanMasks feet_of(const VoxelizedScan& scan, const ScanMasks& objects, const ScanMasks& low);

}  // namespace mosbench::hmm_mos_plus
