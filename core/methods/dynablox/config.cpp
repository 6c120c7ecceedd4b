#include "core/methods/dynablox/config.hpp"

#include <stdexcept>

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

}  // namespace mosbench::dynablox
