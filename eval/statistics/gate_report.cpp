#include "eval/statistics/gate_report.hpp"

#include <fmt/format.h>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {

using nlohmann::ordered_json;

Sheet gate_sheet(const GateResult& result) {
  Sheet sheet{
      .title = result.passed() ? "MOS gate: pass" : "MOS gate: REGRESSION",
      .columns = {{"sequence", Unit::kText},
                  {"baseline IoU", Unit::kPercent},
                  {"new IoU", Unit::kPercent},
                  {"difference", Unit::kPoints},
                  {"tolerance", Unit::kPercent, 2},
                  {"p", Unit::kNumber, 4},
                  {"verdict", Unit::kText}},
      .notes = {result.rule == GateRule::kStatistical
                    ? "95 %: interval of the difference; a drop within its half-width passes"
                    : "95 %: what other scans like these would show; it does not decide "
                      "(--statistical)"}};
  for (const GateCheck& check : result.checks) {
    sheet.rows.push_back({check.name, or_undefined(check.baseline), or_undefined(check.newer),
                          spread_of(check.difference), check.tolerance,
                          or_missing(check.difference.p_value),
                          check.passed ? "pass" : "REGRESSION"});
    const std::string& why = check.difference.no_interval;
    if (!why.empty()) sheet.notes.push_back(fmt::format("no interval for {}: {}", check.name, why));
  }
  sheet.notes.emplace_back(result.passed() ? "pass" : "regression");
  return sheet;
}

std::vector<Annotation> gate_annotations(const GateResult& result) {
  std::vector<Annotation> annotations;
  for (const GateCheck& check : result.checks) {
    if (check.passed) continue;
    const std::string now =
        check.newer ? fmt::format("{} % now: {} points, tolerance {}", percent_text(check.newer),
                                  percent_text(check.difference.value, "{:+.2f}"),
                                  percent_text(check.tolerance, "{:.2f}"))
                    : "undefined now";
    annotations.push_back({fmt::format("IoU of {} dropped", check.name),
                           percent_text(check.baseline) + " % before, " + now});
  }
  return annotations;
}

ordered_json to_json(const GateResult& result) {
  ordered_json json = {{"passed", result.passed()},
                       {"rule", result.rule == GateRule::kStatistical ? "statistical" : "max-drop"},
                       {"checks", ordered_json::array()}};
  for (const GateCheck& check : result.checks) {
    ordered_json& one = json["checks"].emplace_back();
    one = {{"name", check.name},
           {"baseline_iou", json_or_null(check.baseline)},
           {"new_iou", json_or_null(check.newer)},
           {"difference", json_or_null(check.difference.value)}};
    one.update(interval_json(spread_of(check.difference)));
    one["p_value"] = json_or_null(check.difference.p_value);
    one["tolerance"] = check.tolerance;
    one["passed"] = check.passed;
  }
  return json;
}

}  // namespace mosbench
