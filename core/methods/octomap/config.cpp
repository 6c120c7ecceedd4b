#include "core/methods/octomap/config.hpp"

#include "core/base/range_limits.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::octomap {

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
}

}  // namespace mosbench::octomap
