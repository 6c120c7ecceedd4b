#include "core/methods/dufomap/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/dufomap/config.hpp"
#include "core/methods/dufomap/pipeline.hpp"

namespace mosbench::dufomap {

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
