#include "core/methods/lc_free_space/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/lc_free_space/config.hpp"
#include "core/methods/lc_free_space/pipeline.hpp"

namespace mosbench::lc_free_space {

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
