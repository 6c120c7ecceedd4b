#include "core/base/scan_steps.hpp"

#include <utility>

#include "core/base/median.hpp"

namespace mosbench {

std::vector<double> scan_steps_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<double> steps_ns;
  for (std::size_t k = 1; k < stamps_ns.size(); ++k) {
    steps_ns.push_back(static_cast<double>(stamps_ns[k]) - static_cast<double>(stamps_ns[k - 1]));
  }
  return steps_ns;
}

std::optional<double> scan_period_ns(std::vector<double> steps_ns) {
  constexpr double kShortest_ns = 2e6, kLongest_ns = 20e9;
  const double period_ns = upper_median(std::move(steps_ns));  // 0 of none
  if (period_ns < kShortest_ns || period_ns > kLongest_ns) return std::nullopt;
  return period_ns;
}

}  // namespace mosbench
