#include "core/tsdf/config.hpp"

#include <stdexcept>

#include "core/base/range_limits.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::tsdf {

void check_common(const Config& config) {
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
  if (config.range_image_rows == 1 ||
      (config.range_image_columns > 0 && config.range_image_columns < 4)) {
    throw std::invalid_argument(
        "range_image_rows: too small an image, expected at least 2 rows and 4 columns, or 0");
  }
  if (config.field_of_view_down_deg > config.field_of_view_up_deg ||
      (config.field_of_view_down_deg == config.field_of_view_up_deg &&
       config.field_of_view_up_deg != 0)) {
    throw std::invalid_argument(
        "field_of_view_down_deg: not below field_of_view_up_deg, expected down < up, or both 0");
  }
}

}  // namespace mosbench::tsdf
