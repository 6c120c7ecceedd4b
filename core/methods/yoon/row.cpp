#include "core/base/method_row.hpp"
#include "core/base/range_limits.hpp"
#include "core/methods/yoon/config.hpp"
#include "core/methods/yoon/pipeline.hpp"

namespace mosbench::yoon {

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
}

/// "yoon": our reading of a method without published code.
MethodKind method_kind() {
  return {
      .name = "yoon",
      .title = "Yoon et al. (our reading)",
      .source =
          "Yoon, Tang, Barfoot: Mapless Online Detection of Dynamic Objects in 3D Lidar, CRV 2019, "
          "arXiv:1809.06972",
      .summary =
          "our reading: points in free space of a scan before, filtered and grown to objects",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_method<Pipeline, Config>,
      .score_name = "residual, m",
      .threshold_name = "residual of seeds, m"};
}

}  // namespace mosbench::yoon
