#include "core/methods/lc_free_space/config.hpp"

#include <stdexcept>

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

}  // namespace mosbench::lc_free_space
