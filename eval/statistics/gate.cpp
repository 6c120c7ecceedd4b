#include "eval/statistics/gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "eval/results/answer_text.hpp"
#include "eval/results/text_table.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

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

std::string gate_text(const GateResult& result) {
  TextTable table({{"sequence", TextTable::Align::kLeft},
                   {"baseline IoU %"},
                   {"new IoU %"},
                   {"difference"},
                   {"95 %"},
                   {"tolerance"},
                   {"p"},
                   {"verdict"}});
  for (const GateCheck& check : result.checks) {
    table.add_row({check.name, percent_text(check.baseline), percent_text(check.newer),
                   percent_text(check.difference.value, "{:+.2f}"),
                   interval_text(check.difference.interval, "{:+.2f}"),
                   percent_text(check.tolerance, "{:.2f}"),
                   check.difference.p_value ? fmt::format("{:.4f}", *check.difference.p_value) : "",
                   check.passed ? "pass" : "REGRESSION"});
  }
  const char* note =
      result.rule == GateRule::kStatistical
          ? "\n95 %: interval of the difference; a drop within its half-width passes\n"
          : "\n95 %: what other scans like these would show; it does not decide (--statistical)\n";
  std::string text = table.str() + note;
  for (const GateCheck& check : result.checks) {
    if (check.difference.no_interval.empty()) continue;
    text += fmt::format("no interval for {}: {}\n", check.name, check.difference.no_interval);
  }
  return text;
}

nlohmann::ordered_json to_json(const GateResult& result) {
  ordered_json json = {{"passed", result.passed()},
                       {"rule", result.rule == GateRule::kStatistical ? "statistical" : "max-drop"},
                       {"checks", ordered_json::array()}};
  for (const GateCheck& check : result.checks) {
    const std::optional<Interval>& interval = check.difference.interval;
    json["checks"].push_back(
        {{"name", check.name},
         {"baseline_iou", json_or_null(check.baseline)},
         {"new_iou", json_or_null(check.newer)},
         {"difference", json_or_null(check.difference.value)},
         {"low", interval ? ordered_json(interval->low) : ordered_json(nullptr)},
         {"high", interval ? ordered_json(interval->high) : ordered_json(nullptr)},
         {"no_interval", check.difference.no_interval.empty()
                             ? ordered_json(nullptr)
                             : ordered_json(check.difference.no_interval)},
         {"p_value", json_or_null(check.difference.p_value)},
         {"tolerance", check.tolerance},
         {"passed", check.passed}});
  }
  return json;
}

}  // namespace mosbench
