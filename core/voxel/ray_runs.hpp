#pragma once

#include <span>
#include <vector>

#include "core/voxel/exact_rays.hpp"

namespace mosbench {

/// Marks the same voxels as cast_exact with kAtHit, in fewer steps: voxels that a ray crosses side
/// by side along the bytes of the window are marked as one run, which ends where the ray leaves
/// their row or byte. `rays` go farthest along the axis of the windows' bytes. If rounding might
/// decide between two voxels, the ray is appended to `doubtful` and its marks end.
void cast_runs(std::span<const ExactRay> rays, const RayWindow& hits, int beyond_voxels,
               RayWindow& window, std::vector<ExactRay>& doubtful);

}  // namespace mosbench
