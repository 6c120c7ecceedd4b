#include <stdexcept>
#include <string>

#include "core/base/method_row.hpp"
#include "core/methods/octomap/config.hpp"
#include "core/methods/octomap/pipeline.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::octomap {
namespace {

void check_settings(const Settings& settings) {
  if (!how_to_build().empty())
    throw std::invalid_argument("octomap: " + std::string(how_to_build()));
  check(config_of<Config>(settings));
}

std::unique_ptr<Method> make(const Settings& settings, const RunContext& context) {
  return make_pipeline(config_of<Config>(settings), context);
}

}  // namespace

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
}

/// "octomap": points in voxels that OctoMap holds free.
MethodKind method_kind() {
  return {
      .name = "octomap",
      .title = "OctoMap",
      .source =
          "Hornung, Wurm, Bennewitz, Stachniss, Burgard: OctoMap: An Efficient Probabilistic 3D "
          "Mapping Framework Based on Octrees, Autonomous Robots 2013",
      .summary = how_to_build().empty()
                     ? "points in voxels that OctoMap's map of log-odds holds free"
                     : how_to_build(),
      .defaults = settings_of(Config{}),
      .check = check_settings,
      .make = make,
      .score_name = "log-odds of free space",
      .threshold_name = "free above",
      .takes_origins = true};
}

}  // namespace mosbench::octomap
