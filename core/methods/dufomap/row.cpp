#include "core/base/method_row.hpp"
#include "core/base/range_limits.hpp"
#include "core/methods/dufomap/config.hpp"
#include "core/methods/dufomap/pipeline.hpp"
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

/// "dufomap": points in space that was void in some scan.
MethodKind method_kind() {
  return {.name = "dufomap",
          .title = "DUFOMap",
          .source =
              "Duberg, Zhang, Jia, Jensfelt: DUFOMap: Efficient Dynamic Awareness Mapping, IEEE "
              "Robotics and Automation Letters 2024, arXiv:2403.01449",
          .summary = "points in space that some scan saw to be void, on a map of one bit per voxel",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "seen void"};
}

}  // namespace mosbench::dufomap
