#include "core/methods/dufomap/config.hpp"

#include "core/base/range_limits.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::dufomap {

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.resolution_m, "resolution_m",
               kMaxRangeVoxels);
  check_voxels("sensor_noise_m", config.sensor_noise_m / config.resolution_m, "resolution_m",
               kMaxRangeVoxels);
}

}  // namespace mosbench::dufomap
