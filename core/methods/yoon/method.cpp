#include "core/methods/yoon/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/yoon/config.hpp"
#include "core/methods/yoon/pipeline.hpp"

namespace mosbench::yoon {

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
