#include "eval/breakdown/scan_times.hpp"

#include <optional>

namespace mosbench {
namespace {

/// Assumed without stamps: the LiDARs of all supported data sets turn at 10 Hz.
constexpr double kScanPeriod_s = 0.1;

/// Returns seconds since the first scan; nullopt unless every scan has a stamp and the stamps
/// increase.
std::optional<std::vector<double>> stamped_times_s(const Sequence& sequence,
                                                   const std::vector<std::size_t>& scans) {
  std::vector<double> times_s;
  std::optional<std::int64_t> first_ns;
  for (const std::size_t k : scans) {
    const std::optional<std::int64_t> stamp_ns = sequence.stamp_ns(k);
    if (!stamp_ns) return std::nullopt;
    if (!first_ns) first_ns = stamp_ns;
    times_s.push_back(static_cast<double>(*stamp_ns - *first_ns) * 1e-9);
    if (times_s.size() > 1 && times_s.back() <= times_s[times_s.size() - 2]) return std::nullopt;
  }
  return times_s;
}

}  // namespace

ScanTimes scan_times(const Sequence& sequence, const std::vector<std::size_t>& scans) {
  if (auto times_s = stamped_times_s(sequence, scans)) return {*std::move(times_s), true};
  ScanTimes assumed;
  for (const std::size_t k : scans) {
    assumed.times_s.push_back(static_cast<double>(k) * kScanPeriod_s);
  }
  return assumed;
}

}  // namespace mosbench
