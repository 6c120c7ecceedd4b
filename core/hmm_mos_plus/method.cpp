#include "core/hmm_mos_plus/method.hpp"

#include "core/base/method_row.hpp"
#include "core/hmm_mos_plus/config.hpp"
#include "core/hmm_mos_plus/pipeline.hpp"

namespace mosbench::hmm_mos_plus {

MethodKind method_kind() {
  return {"hmm-mos-plus",
          "HMM-MOS plus",
          "mosbench, core/hmm_mos_plus/README.md",
          "objects that arrive in space known to be free, on the map of hmm-mos",
          settings_of(Config{}),
          check_settings<Config>,
          make_method<Pipeline, Config>,
          false,
          "share of seeds",
          "least share of seeds"};
}

}  // namespace mosbench::hmm_mos_plus
