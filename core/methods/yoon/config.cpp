#include "core/methods/yoon/config.hpp"

#include "core/base/range_limits.hpp"

namespace mosbench::yoon {

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
}

}  // namespace mosbench::yoon
