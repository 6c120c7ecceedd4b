#include "datasets/formats/point_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::array<double, 4> kNsPerUnit = {1e9, 1e6, 1e3, 1.0};
constexpr double kShortestSweep_s = 0.005, kLongestSweep_s = 1.0;
/// Sweeps overlap a little, and steps jitter.
constexpr double kLongestSweep_steps = 1.5;
/// No sweep of a slow sensor is longer.
constexpr double kLongestOfAll_s = 2.0;

std::vector<double> finite(std::span<const double> times, bool with_zeros) {
  std::vector<double> kept;
  for (const double time : times) {
    if (std::isfinite(time) && (with_zeros || time != 0.0)) kept.push_back(time);
  }
  std::ranges::sort(kept);
  return kept;
}

/// Returns the first and one past the last of the most sorted times that are within `width`.
std::pair<std::size_t, std::size_t> densest(std::span<const double> sorted, double width) {
  std::pair<std::size_t, std::size_t> best{0, 0};
  std::size_t from = 0;
  for (std::size_t to = 0; to < sorted.size(); ++to) {
    while (sorted[to] - sorted[from] > width) ++from;
    if (to + 1 - from > best.second - best.first) best = {from, to + 1};
  }
  return best;
}

/// Whether many other times lie near those from `first` to `last`: a longer sweep, not points that
/// are off.
bool goes_on(std::span<const double> sorted, double first, double last, std::size_t inside,
             double longest) {
  constexpr double kNear = 10.0;
  const auto near = std::ranges::count_if(sorted, [&](double time) {
    return time >= first - kNear * longest && time <= last + kNear * longest;
  });
  return 5 * (static_cast<std::size_t>(near) - inside) > inside;
}

/// How long 90 % of the times last: a few that are off make no sweep.
double usual_span(std::span<const double> sorted) {
  const auto skipped = static_cast<std::size_t>(0.05 * static_cast<double>(sorted.size() - 1));
  return sorted[sorted.size() - 1 - skipped] - sorted[skipped];
}

/// Whether many points have one time, as those of a scan that lost its times.
bool are_at_once(std::span<const double> times) {
  constexpr std::size_t kMany = 100;
  return times.size() >= kMany &&
         std::ranges::adjacent_find(times, std::not_equal_to()) == times.end();
}

/// From 0 to 1, whatever the sensor: shares, unless a sweep lasts a second.
bool are_shares(std::span<const double> sorted) {
  return sorted.front() >= -1e-3 && sorted.back() <= 1.001 && usual_span(sorted) > 0.7;
}

}  // namespace

std::optional<TimeUnit> unit_within(double number, double lowest_s, double highest_s) {
  for (std::size_t unit = 0; unit < kNsPerUnit.size(); ++unit) {
    const double time_s = number * kNsPerUnit[unit] * 1e-9;
    if (time_s >= lowest_s && time_s < highest_s) return static_cast<TimeUnit>(unit);
  }
  return std::nullopt;
}

std::optional<TimeUnit> unit_since_1970(double number) { return unit_within(number, 6.3e8, 4.4e9); }

double usual_step(std::span<const double> stamps, double q) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    if (stamps[k] > stamps[k - 1]) steps.push_back(stamps[k] - stamps[k - 1]);
  }
  return steps.empty() ? 0.0 : quantile(std::move(steps), q, QuantileRule::kUpper);
}

TimeUnit unit_of_stamps(std::span<const double> stamps) {
  // A gap between two of few is no unit.
  if (stamps.size() >= 4 && usual_step(stamps, 0.1) > kLongestKept_s) {
    const auto by_step = unit_within(usual_step(stamps), 0.02, 5.0);
    if (by_step) return *by_step;
  }
  return stamps.empty() ? TimeUnit::kSeconds
                        : unit_since_1970(stamps.front()).value_or(TimeUnit::kSeconds);
}

double PointClock::longest_s() const {
  if (!step_s_) return kLongestSweep_s;
  return std::min(kLongestSweep_steps * *step_s_, kLongestOfAll_s);
}

double PointClock::seconds_of(TimeUnit unit) const {
  if (unit == TimeUnit::kSteps) return step_s_.value_or(0.1);
  return kNsPerUnit[static_cast<std::size_t>(unit)] * 1e-9;
}

std::optional<PointClock::Sweep> PointClock::sweep_of(std::span<const double> times,
                                                      TimeUnit unit) const {
  if (times.empty()) return std::nullopt;
  const double longest = longest_s() / seconds_of(unit);
  const auto [first, last] = std::ranges::minmax(times);
  const bool all = std::ranges::all_of(times, [](double time) { return std::isfinite(time); });
  if (all && last - first <= longest) return Sweep{first, last};
  // Drivers store 0 for points without a return.
  for (const bool with_zeros : {true, false}) {
    const std::vector<double> sorted = finite(times, with_zeros);
    const auto [from, to] = densest(sorted, longest);
    if (to - from < 2 || 2 * (to - from) < sorted.size()) continue;
    if (sorted[from] == 0.0 && sorted[to - 1] == 0.0) continue;
    if (goes_on(sorted, sorted[from], sorted[to - 1], to - from, longest)) continue;
    return Sweep{sorted[from], sorted[to - 1]};
  }
  return std::nullopt;
}

bool PointClock::fits(std::span<const double> times, TimeUnit unit) const {
  const auto sweep = sweep_of(times, unit);
  if (!sweep) return false;
  std::vector<double> sorted = finite(times, true);
  std::erase_if(sorted, [&](double time) { return time < sweep->first || time > sweep->last; });
  if (unit == TimeUnit::kSteps) return are_shares(sorted);
  // Without the time between scans, shares cannot be told from seconds.
  if (!step_s_ && unit == TimeUnit::kSeconds && are_shares(sorted)) return false;
  const double shortest_s = std::min(kShortestSweep_s, 0.1 * step_s_.value_or(1.0));
  return unit_within(usual_span(sorted), shortest_s, 1.001 * longest_s()) == unit;
}

PointClock::PointClock(std::span<const StoredTimes> scans, std::optional<double> step_s,
                       std::optional<TimeUnit> told)
    : step_s_(step_s), unit_(told) {
  if (!unit_) judge_unit(scans);
  if (!unit_) return;
  judge_origin(scans);
  count_bad(scans);
}

void PointClock::judge_unit(std::span<const StoredTimes> scans) {
  std::array<std::size_t, kTimeUnitNames.size()> scans_of{};
  std::size_t best = 0;
  double span = 0.0;
  for (std::size_t unit = 0; unit < scans_of.size(); ++unit) {
    if (static_cast<TimeUnit>(unit) == TimeUnit::kSteps && (!step_s_ || scans_of[best] > 0)) break;
    scans_of[unit] = static_cast<std::size_t>(std::ranges::count_if(
        scans, [&](const auto& scan) { return fits(scan.times, static_cast<TimeUnit>(unit)); }));
    if (scans_of[unit] > scans_of[best]) best = unit;
  }
  if (2 * scans_of[best] > scans.size() ||
      (scans_of[best] > 0 && std::ranges::count(scans_of, scans_of[best]) == 1)) {
    unit_ = static_cast<TimeUnit>(best);
    return;
  }
  for (const StoredTimes& scan : scans) {
    const std::vector<double> sorted = finite(scan.times, true);
    if (!sorted.empty()) span = std::max(span, usual_span(sorted));
  }
  if (span == 0.0) {
    text_ = "not used, they are all the same within a scan";
    // Zeros are those of scans that were taken, or moved to, one instant.
    is_odd_ = std::ranges::any_of(scans, [](const StoredTimes& scan) {
      return std::ranges::any_of(scan.times, [](double time) { return time != 0.0; });
    });
    return;
  }
  is_odd_ = true;
  text_ = fmt::format(
      "not used, they span {:g} as stored: in s, ms, us or ns no sweep of {:g} ms to {:g} s", span,
      1e3 * kShortestSweep_s, longest_s());
}

double PointClock::origin_ns(const Sweep& sweep, const StoredTimes& scan) const {
  if (origin_ == Origin::kStamp) return 0.0;
  if (origin_ == Origin::kFirst || !scan.stamp_ns) return sweep.first * seconds_of(*unit_) * 1e9;
  return static_cast<double>(*scan.stamp_ns);
}

void PointClock::judge_origin(std::span<const StoredTimes> scans) {
  double off_stamp_s = 0.0, off_clock_s = 0.0, span_s = 0.0;
  std::size_t near_stamp = 0, near_clock = 0, all = 0;
  const double limit_s = std::max(kLongestSweep_s, longest_s());
  for (const StoredTimes& scan : scans) {
    const auto sweep = sweep_of(scan.times, *unit_);
    if (!sweep) continue;
    ++all;
    const double first_s = sweep->first * seconds_of(*unit_);
    const double last_s = sweep->last * seconds_of(*unit_);
    span_s = std::max(span_s, last_s - first_s);
    const auto add = [&](double since_s, double& off_s, std::size_t& near) {
      const double off = std::max(std::abs(first_s - since_s), std::abs(last_s - since_s));
      off_s += off;
      near += off <= limit_s;
    };
    add(0.0, off_stamp_s, near_stamp);
    if (scan.stamp_ns) add(1e-9 * static_cast<double>(*scan.stamp_ns), off_clock_s, near_clock);
  }
  // Also true of most of a simulation's first second.
  const bool by_clock =
      near_clock > near_stamp || (near_clock == near_stamp && off_clock_s < off_stamp_s);
  if (2 * std::max(near_clock, near_stamp) < all || all == 0) {
    origin_ = Origin::kFirst;
  } else {
    origin_ = by_clock ? Origin::kClockOfStamp : Origin::kStamp;
  }
  constexpr std::array<std::string_view, 3> kOrigins = {
      "since the scan's stamp", "by the clock of the scan's stamp",
      "by another clock, after the scan's first point"};
  is_odd_ = unit_ == TimeUnit::kSteps;
  text_ = fmt::format(
      "{} {}, span {:.1f} ms",
      unit_ == TimeUnit::kSteps ? "shares of the time between scans" : to_string(*unit_),
      kOrigins[static_cast<std::size_t>(origin_)], 1e3 * span_s);
}

void PointClock::count_bad(std::span<const StoredTimes> scans) {
  std::size_t bad_points = 0, scans_of_bad = 0, raw_scans = 0;
  for (const StoredTimes& scan : scans) {
    if (scan.times.empty()) continue;
    const std::vector<std::int64_t> times_ns = after_stamp_ns(scan);
    const auto bad = static_cast<std::size_t>(std::ranges::count(times_ns, kNoTime));
    raw_scans += times_ns.empty() || are_at_once(scan.times);
    bad_points += bad;
    scans_of_bad += bad > 0;
  }
  if (raw_scans + bad_points == 0) return;
  std::string bad;
  if (bad_points > 0) bad = counted(bad_points, "point") + " in " + counted(scans_of_bad, "scan");
  if (raw_scans > 0) bad += (bad.empty() ? "" : " and ") + counted(raw_scans, "whole scan");
  doubt_ = fmt::format(
      "the times of {}, of {} looked at, cannot be: they are left as they were measured", bad,
      counted(scans.size(), "scan"));
}

std::vector<std::int64_t> PointClock::after_stamp_ns(const StoredTimes& scan) const {
  if (!unit_) return {};
  const auto sweep = sweep_of(scan.times, *unit_);
  if (!sweep) return {};
  const double ns = *unit_ == TimeUnit::kSteps ? 1e9 * seconds_of(*unit_)
                                               : kNsPerUnit[static_cast<std::size_t>(*unit_)];
  const double limit_ns = 1e9 * std::max(kLongestSweep_s, longest_s());
  // The difference of large numbers first: it is exact.
  const double base = origin_ == Origin::kStamp ? 0.0 : sweep->first;
  const double base_ns = origin_ == Origin::kStamp ? 0.0 : base * ns - origin_ns(*sweep, scan);
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(scan.times.size());
  for (const double time : scan.times) {
    const double after_ns = base_ns + (time - base) * ns;
    const bool is_good =
        time >= sweep->first && time <= sweep->last && std::abs(after_ns) <= limit_ns;
    times_ns.push_back(is_good ? std::llround(after_ns) : kNoTime);
  }
  if (std::ranges::all_of(times_ns, [](std::int64_t time) { return time == kNoTime; })) return {};
  return times_ns;
}

void settle_times(std::vector<std::int64_t>& times_ns, std::int64_t reference_ns) {
  std::ranges::replace(times_ns, kNoTime, reference_ns);
}

}  // namespace mosbench
