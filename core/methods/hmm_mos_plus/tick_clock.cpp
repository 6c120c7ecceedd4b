#include "core/methods/hmm_mos_plus/tick_clock.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench::hmm_mos_plus {
namespace {

constexpr double kTick_ns = TickClock::kSeconds * 1e9;
/// More periods than these between two scans change nothing any more.
constexpr double kLongestGapPeriods = 1e4;

/// Returns stamps[k] - stamps[k - 1] for each k but the first, as double: the difference of two
/// arbitrary stamps may not fit.
std::vector<double> distances_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<double> distances;
  for (std::size_t k = 1; k < stamps_ns.size(); ++k) {
    distances.push_back(static_cast<double>(stamps_ns[k]) - static_cast<double>(stamps_ns[k - 1]));
  }
  return distances;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

TickClock::TickClock(std::span<const std::int64_t> stamps_ns) {
  const std::vector<double> apart_ns = distances_ns(stamps_ns);
  if (apart_ns.empty()) return;
  const double period_ns = median(apart_ns);
  if (period_ns <= 0) return;  // stamps that tell no time
  const double measured = period_ns / kTick_ns;
  const double ticks_per_period = measured >= 0.8 && measured <= 1.25 ? 1.0 : measured;
  double periods = 0, last_tick = 0;
  const double period_s = ticks_per_period * kSeconds;
  ticks_.push_back({.period_s = period_s});
  for (const double distance_ns : apart_ns) {
    const double passed = std::clamp(std::round(distance_ns / period_ns), 1.0, kLongestGapPeriods);
    periods += passed;
    const double tick = std::floor(periods * ticks_per_period);
    const auto steps = static_cast<std::uint32_t>(std::min(tick - last_tick, 1e9));
    ticks_.push_back(
        {ticks_.back().at + steps, steps, static_cast<std::uint32_t>(passed), period_s});
    last_tick = tick;
  }
}

Tick TickClock::of(std::uint32_t scan_index) const {
  if (scan_index < ticks_.size()) return ticks_[scan_index];
  if (ticks_.empty()) return {.at = scan_index};
  const auto behind = scan_index - static_cast<std::uint32_t>(ticks_.size() - 1);
  return {.at = ticks_.back().at + behind};
}

}  // namespace mosbench::hmm_mos_plus
