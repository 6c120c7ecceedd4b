#include "core/base/method_row.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/pipeline.hpp"

namespace mosbench::hmm_mos_plus {

void check(const Config& config) {
  check_ranges(config);
  hmm_mos::check(config.map);
}

/// "hmm-mos-plus": the paper's method, completed to objects.
MethodKind method_kind() {
  return {.name = "hmm-mos-plus",
          .title = "HMM-MOS plus",
          .source = "mosbench, docs/methods/hmm_mos_plus.md",
          .summary = "objects that arrive in space known to be free, on the map of hmm-mos",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "share of seeds",
          .threshold_name = "least share of seeds",
          .gives_reasons = true,
          .words = {{.name = "moving",
                     .usual = "now",
                     .value = "ever",
                     .number = "SECONDS",
                     .takes = {"seed_age_s", "object_age_s", "fresh_age_s"},
                     .sets = {{"max_aged_share", 1}},
                     .lacking = "does not remember what moved"}}};
}

}  // namespace mosbench::hmm_mos_plus
