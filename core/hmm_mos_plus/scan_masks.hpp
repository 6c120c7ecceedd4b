#pragma once

#include <vector>

#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos_plus {

/// Voxels of a scan: masks in the order of scan.measured.blocks.
using ScanMasks = std::vector<BlockMask>;

}  // namespace mosbench::hmm_mos_plus
