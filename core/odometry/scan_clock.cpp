#include "core/odometry/scan_clock.hpp"

#include <sstream>

namespace mosbench::odometry {
namespace {

constexpr double kGapPeriods = 2.5;

}  // namespace

ScanClock::ScanClock(double default_period_s)
    : period_ns_(static_cast<std::int64_t>(default_period_s * 1e9)) {}

ScanClock::Interval ScanClock::tick(std::optional<std::int64_t> stamp_ns) {
  if (!stamp_ns || !last_ns_) {
    last_ns_ = stamp_ns;
    return {.period_ns = period_ns_, .doubt = {}};
  }
  // As double: the difference of two arbitrary stamps may not fit.
  const double passed_ns = static_cast<double>(*stamp_ns) - static_cast<double>(*last_ns_);
  if (!(passed_ns > 0)) {
    return {.period_ns = period_ns_, .doubt = "its stamp is not after that of the scan before"};
  }
  last_ns_ = stamp_ns;
  const double periods = passed_ns / static_cast<double>(period_ns_);
  if (measured_ && periods > kGapPeriods) {
    std::ostringstream doubt;
    doubt.precision(3);
    doubt << "it comes " << passed_ns * 1e-9 << " s after the scan before";
    return {.period_ns = period_ns_, .periods = periods, .doubt = doubt.str()};
  }
  // A first interval of any length is what is usual, if it can be.
  if (passed_ns < 1e12 && passed_ns >= 1e5) {
    period_ns_ = static_cast<std::int64_t>(passed_ns);
    measured_ = true;
  }
  return {.period_ns = period_ns_, .doubt = {}};
}

}  // namespace mosbench::odometry
