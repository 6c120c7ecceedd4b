#pragma once

#include <span>
#include <vector>

#include "core/voxel/exact_rays.hpp"

namespace mosbench {

/// Marks what cast_exact with kAtHit marks, the same voxels, in fewer steps: those that a ray
/// crosses side by side along the bytes of the window are marked as one run, whose end is where the
/// ray leaves their row or byte. `rays` go farthest along the axis of the windows' bytes. Where
/// rounding might decide between two voxels, a ray is appended to `doubtful` and its marks end.
void cast_runs(std::span<const ExactRay> rays, const RayWindow& hits, int beyond_voxels,
               RayWindow& window, std::vector<ExactRay>& doubtful);

}  // namespace mosbench
