#include "core/methods/hmm_mos_plus/config.hpp"

namespace mosbench::hmm_mos_plus {

void check(const Config& config) {
  check_ranges(config);
  hmm_mos::check(config.map);
}

}  // namespace mosbench::hmm_mos_plus
