#include <stdexcept>

#include "core/base/method_row.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/methods/dynablox/pipeline.hpp"

namespace mosbench::dynablox {

void check(const Config& config) {
  check_ranges(config);
  tsdf::check_common(config);
  if (config.occupied_below_voxels > config.truncation_voxels) {
    throw std::invalid_argument(
        "occupied_below_voxels: above truncation_voxels, which no distance exceeds, expected "
        "occupied <= truncation");
  }
}

/// "dynablox": objects in space that was free for long.
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
