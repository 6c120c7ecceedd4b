#include "datasets/formats/point_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::array<std::string_view, 4> kTimeFieldNames = {"t", "time", "timestamp",
                                                             "offset_time"};
constexpr double kShortestScan_s = 0.005, kLongestScan_s = 1.0;
constexpr std::array<double, 4> kUnits_s = {1.0, 1e-3, 1e-6, 1e-9};
/// Later than any point of a scan that is counted from its stamp.
constexpr double kSinceEpoch_s = 10.0;

constexpr const char* kExpectedTimes =
    "times of 5 ms to 1 s per scan, in s, ms, us or ns, in the field t, time, timestamp or "
    "offset_time";

/// The unit in which a scan lasts as long as scans do.
double unit_s(double span, const std::filesystem::path& file) {
  for (const double unit : kUnits_s) {
    if (span * unit >= kShortestScan_s && span * unit <= kLongestScan_s) return unit;
  }
  throw DataError(file, fmt::format("the times of its points span {:g}", span), kExpectedTimes);
}

/// What times count from, in nanoseconds after the stamp's own zero or the first time's.
double origin_ns(double first_ns, std::optional<std::int64_t> stamp_ns) {
  if (std::abs(first_ns) < kSinceEpoch_s * 1e9) return 0;
  const double stamp = stamp_ns ? static_cast<double>(*stamp_ns) : first_ns;
  return std::abs(first_ns - stamp) <= kLongestScan_s * 1e9 ? stamp : first_ns;
}

}  // namespace

bool is_time_field(std::string_view name) {
  return std::ranges::find(kTimeFieldNames, name) != kTimeFieldNames.end();
}

const CloudField* find_time_field(const CloudHead& head) {
  const auto field = std::ranges::find_if(head.fields, is_time_field, &CloudField::name);
  return field == head.fields.end() ? nullptr : &*field;
}

std::vector<std::int64_t> times_after_stamp_ns(std::span<const double> stored,
                                               std::optional<std::int64_t> stamp_ns,
                                               const std::filesystem::path& file) {
  if (stored.size() < 2) return std::vector<std::int64_t>(stored.size(), 0);
  const auto bad = std::ranges::find_if_not(stored, [](double t) { return std::isfinite(t); });
  if (bad != stored.end()) {
    throw DataError(file, fmt::format("point {} has no finite time", bad - stored.begin()),
                    kExpectedTimes);
  }
  const auto [first, last] = std::ranges::minmax(stored);
  const double to_ns = 1e9 * unit_s(last - first, file);
  const double first_ns = first * to_ns - origin_ns(first * to_ns, stamp_ns);
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(stored.size());
  for (const double time : stored)
    times_ns.push_back(std::llround(first_ns + (time - first) * to_ns));
  return times_ns;
}

}  // namespace mosbench
