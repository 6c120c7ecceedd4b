#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mosbench {

/// Returns stamps[k] - stamps[k - 1] for each k but the first, as double: the difference of two
/// arbitrary stamps may not fit.
std::vector<double> scan_steps_ns(std::span<const std::int64_t> stamps_ns);

/// Returns the median step. Nothing where there is none, and below 2 ms or above 20 s: such stamps
/// tell no time, they are equal, fall, or are in another unit.
std::optional<double> scan_period_ns(std::vector<double> steps_ns);

}  // namespace mosbench
