#include "core/methods/dynablox/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/methods/dynablox/pipeline.hpp"

namespace mosbench::dynablox {

MethodKind method_kind() {
  return {.name = "dynablox",
          .title = "Dynablox",
          .source =
              "Schmid, Andersson, Sulser, Pfreundschuh, Siegwart: Dynablox: Real-time Detection of "
              "Diverse Dynamic Objects in Complex Environments, RA-L 2023, arXiv:2304.10049",
          .summary = "clusters of points in space that a volumetric map has seen free for long",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "distance to surfaces (tau more if ever-free), m"};
}

}  // namespace mosbench::dynablox
