#include "core/odometry/config.hpp"

#include "core/base/range_limits.hpp"

namespace mosbench::odometry {

void check(const SimpleConfig& config) {
  check_ranges(config);
  check_range_limits(config.scan.min_range_m, config.scan.max_range_m);
}

void check(const KissConfig& config) {
  check_ranges(config);
  check_range_limits(config.scan.min_range_m, config.scan.max_range_m);
}

}  // namespace mosbench::odometry
