#pragma once

#include <cstddef>
#include <vector>

#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/ground.hpp"

namespace mosbench::hmm_mos_plus {

/// Connected voxels of a scan that hold a seed; the numbers are those of VoxelizedScan. One that
/// moves holds its seeds, and what is near them and does not stand.
struct Component {
  std::vector<std::uint32_t> voxels;
  double seed_share = 0;  ///< seeds / voxels
  bool moves = false;     ///< enough seeds, some of them fresh, of an object's age and size
  int steady_steps = 0;   ///< over which it was followed at a steady velocity
};

struct Box {
  Voxel low, high;  // both included
};

/// Returns the box around some voxels of a scan.
Box box_of(const VoxelizedScan& scan, const std::vector<std::uint32_t>& voxels);

/// The motion found in a scan.
struct Motion {
  std::vector<Component> components;  ///< all that hold a seed
  ScanMasks objects;                  ///< voxels of the components that move
  ScanMasks feet;                     ///< low voxels under those, straight or diagonally
};

/// Finds the components (26 neighbours) of the seeds and of the occupied voxels that are neither
/// settled nor low, those that hold a seed, and which of them move.
std::vector<Component> find_components(const VoxelizedScan& scan, const ArrivalClasses& classes,
                                       const Ground& ground, LowVoxels& low, const Config& config);

/// Returns the motion of a scan's components: the voxels of those that move, and their feet.
Motion motion_of(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low,
                 std::vector<Component> components);

}  // namespace mosbench::hmm_mos_plus
