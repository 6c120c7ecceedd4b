#pragma once

#include "core/hmm_mos_plus/scan_masks.hpp"

namespace mosbench::hmm_mos_plus {

/// Returns the low voxels of a scan, its masks in the order of scan.measured.blocks: occupied ones
/// at most `layers` above the lowest occupied voxel in the columns within `radius` per axis.
/// `radius` from 0 to kBlockSide.
ScanMasks low_voxels(const VoxelizedScan& scan, int radius, int layers);

}  // namespace mosbench::hmm_mos_plus
