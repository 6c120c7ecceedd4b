#include "core/yoon/method.hpp"

#include "core/base/method_row.hpp"
#include "core/yoon/config.hpp"
#include "core/yoon/pipeline.hpp"

namespace mosbench::yoon {

MethodKind method_kind() {
  return {"yoon",
          "Yoon et al. (our reading)",
          "Yoon, Tang, Barfoot: Mapless Online Detection of Dynamic Objects in 3D Lidar, CRV 2019, "
          "arXiv:1809.06972",
          "our reading: points in free space of a scan before, filtered and grown to objects",
          settings_of(Config{}),
          check_settings<Config>,
          make_method<Pipeline, Config>,
          false,
          "residual, m",
          "residual of seeds, m"};
}

}  // namespace mosbench::yoon
