#include "core/dufomap/method.hpp"

#include "core/base/method_row.hpp"
#include "core/dufomap/config.hpp"
#include "core/dufomap/pipeline.hpp"

namespace mosbench::dufomap {

MethodKind method_kind() {
  return {"dufomap",
          "DUFOMap",
          "Duberg, Zhang, Jia, Jensfelt: DUFOMap: Efficient Dynamic Awareness Mapping, IEEE "
          "Robotics and Automation Letters 2024, arXiv:2403.01449",
          "points in space that some scan saw to be void, on a map of one bit per voxel",
          settings_of(Config{}),
          check_settings<Config>,
          make_method<Pipeline, Config>,
          false,
          "seen void"};
}

}  // namespace mosbench::dufomap
