#include "core/lc_free_space/method.hpp"

#include "core/base/method_row.hpp"
#include "core/lc_free_space/config.hpp"
#include "core/lc_free_space/pipeline.hpp"

namespace mosbench::lc_free_space {

MethodKind method_kind() {
  return {"lc-free-space",
          "LC Free Space (our reading)",
          "Modayil, Kuipers: The Initial Development of Object Knowledge by a Learning Robot, "
          "Robotics and Autonomous Systems 56, 2008, as a row of Dynablox's table, "
          "arXiv:2304.10049; no code for it was published",
          "points in space that a volumetric map holds free, and those beside them",
          settings_of(Config{}),
          check_settings<Config>,
          make_method<Pipeline, Config>,
          false,
          "distance to surfaces, m"};
}

}  // namespace mosbench::lc_free_space
