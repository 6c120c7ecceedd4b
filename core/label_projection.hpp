#pragma once

#include <cstdint>
#include <vector>

#include "core/voxel_set.hpp"
#include "core/voxelize.hpp"

namespace mosbench {

/// algorithm step 5h: kMovingLabel for points in a voxel of `moving`, kStaticLabel for all others.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving);

}  // namespace mosbench
