#include <stdexcept>

#include "core/base/method_row.hpp"
#include "core/methods/lc_free_space/config.hpp"
#include "core/methods/lc_free_space/pipeline.hpp"

namespace mosbench::lc_free_space {

void check(const Config& config) {
  check_ranges(config);
  tsdf::check_common(config);
  if (config.free_above_m() >= config.truncation_m()) {
    throw std::invalid_argument(
        "free_above_voxels: not below truncation_voxels, which no distance exceeds, expected "
        "threshold < truncation");
  }
}

/// "lc-free-space": points in space that a volumetric map holds free.
MethodKind method_kind() {
  return {.name = "lc-free-space",
          .title = "LC Free Space (our reading)",
          .source =
              "Modayil, Kuipers: The Initial Development of Object Knowledge by a Learning Robot, "
              "Robotics and Autonomous Systems 56, 2008, as a row of Dynablox's table, "
              "arXiv:2304.10049; no code for it was published",
          .summary = "points in space that a volumetric map holds free, and those beside them",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "distance to surfaces, m"};
}

}  // namespace mosbench::lc_free_space
