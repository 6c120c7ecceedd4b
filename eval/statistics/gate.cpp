#include "eval/statistics/gate.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench {
namespace {

/// Rounding of a difference of two fractions must not decide at exactly max_drop.
constexpr double kRounding = 1e-12;

std::optional<double> iou_of(const Protocol& protocol, std::span<const SequenceCounts> sequences) {
  const double iou = aggregate(protocol, sequences)[static_cast<std::size_t>(Metric::kIou)];
  if (std::isnan(iou)) return std::nullopt;
  return iou;
}

GateCheck check(std::string name, const Protocol& protocol, std::span<const SequenceCounts> first,
                std::span<const SequenceCounts> second, Spacing spacing, double max_drop,
                GateRule rule) {
  GateCheck check;
  check.name = std::move(name);
  check.baseline = iou_of(protocol, first);
  check.newer = iou_of(protocol, second);
  check.tolerance = max_drop;
  if (!check.baseline || !check.newer) {
    check.passed = !check.baseline;
    return check;
  }
  check.difference = paired_difference(protocol, first, second, spacing)[Metric::kIou];
  const double value = *check.difference.value;
  if (rule == GateRule::kStatistical && check.difference.interval) {
    check.tolerance = std::max(max_drop, check.difference.interval->high - value);
  }
  check.passed = value >= -check.tolerance - kRounding;
  return check;
}

}  // namespace

bool GateResult::passed() const { return std::ranges::all_of(checks, &GateCheck::passed); }

GateResult judge(const PairedRuns& paired, const Protocol& protocol, double max_drop,
                 GateRule rule) {
  GateResult result{rule, {}};
  std::size_t scan = 0;
  for (std::size_t s = 0; s < paired.first.size(); ++s) {
    if (paired.first[s].empty()) continue;
    result.checks.push_back(check(paired.scans[scan].sequence, protocol, {&paired.first[s], 1},
                                  {&paired.second[s], 1}, paired.spacing, max_drop, rule));
    scan += paired.first[s].size();
  }
  if (result.checks.size() > 1) {
    result.checks.push_back(
        check("all", protocol, paired.first, paired.second, paired.spacing, max_drop, rule));
  }
  return result;
}

}  // namespace mosbench
