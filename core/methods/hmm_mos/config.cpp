#include "core/methods/hmm_mos/config.hpp"

#include <stdexcept>
#include <string>

#include "core/base/range_limits.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/voxel/distance_field.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::hmm_mos {

void check(const Config& config) {
  check_ranges(config);
  if (config.kernel_width_voxels % 2 == 0) {
    throw std::invalid_argument(
        "kernel_width_voxels: " + std::to_string(config.kernel_width_voxels) +
        " is even, expected an odd width");
  }
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
  // The distance field reaches as far as a likelihood can change a state.
  const double reach_per_sigma =
      likelihood_reach_sigmas(config.transition_epsilon, config.min_state_probability);
  check_voxels("occupancy_sigma_m", config.sigma_m() / config.voxel_size_m, "voxel_size_m",
               kMaxDistanceRadius / reach_per_sigma);
  if (config.variant == Variant::kRelease2025 && config.delay_scans != 0) {
    throw std::invalid_argument("delay_scans: " + std::to_string(config.delay_scans) +
                                " in release-2025, which has no delay, expected 0");
  }
}

}  // namespace mosbench::hmm_mos
