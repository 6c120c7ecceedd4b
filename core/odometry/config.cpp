#include "core/odometry/config.hpp"

#include <stdexcept>

namespace mosbench::odometry {
namespace {

void check_window(const ScanConfig& scan) {
  if (scan.min_range_m >= scan.max_range_m) {
    throw std::invalid_argument("min_range_m: not below max_range_m, expected min < max");
  }
}

}  // namespace

void check(const SimpleConfig& config) {
  check_ranges(config);
  check_window(config.scan);
}

void check(const KissConfig& config) {
  check_ranges(config);
  check_window(config.scan);
}

}  // namespace mosbench::odometry
