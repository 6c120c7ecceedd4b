#include "eval/statistics/gate_report.hpp"

#include <fmt/format.h>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/markdown.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using Cells = std::vector<std::string>;

const Cells kColumns = {"sequence", "baseline IoU %", "new IoU %", "difference",
                        "95 %",     "tolerance",      "p",         "verdict"};

Cells cells_of(const GateCheck& check) {
  return {check.name,
          percent_text(check.baseline),
          percent_text(check.newer),
          percent_text(check.difference.value, "{:+.2f}"),
          interval_text(check.difference.interval, "{:+.2f}"),
          percent_text(check.tolerance, "{:.2f}"),
          check.difference.p_value ? fmt::format("{:.4f}", *check.difference.p_value) : "",
          check.passed ? "pass" : "REGRESSION"};
}

/// Returns what the interval says, and for which sequences there is none, a line each.
Cells notes_of(const GateResult& result) {
  Cells notes = {
      result.rule == GateRule::kStatistical
          ? "95 %: interval of the difference; a drop within its half-width passes"
          : "95 %: what other scans like these would show; it does not decide (--statistical)"};
  for (const GateCheck& check : result.checks) {
    if (check.difference.no_interval.empty()) continue;
    notes.push_back(
        fmt::format("no interval for {}: {}", check.name, check.difference.no_interval));
  }
  return notes;
}

/// Escapes the message of a workflow command, and what else would end a property of one.
std::string workflow_text(std::string_view text, std::string_view also = "") {
  std::string escaped;
  for (const char c : text) {
    const bool escape = c == '%' || c == '\r' || c == '\n' || also.find(c) != also.npos;
    escaped += escape ? fmt::format("%{:02X}", c) : std::string(1, c);
  }
  return escaped;
}

}  // namespace

std::string gate_text(const GateResult& result) {
  std::vector<TextTable::Column> columns;
  for (const std::string& column : kColumns) columns.push_back({column});
  columns.front().align = TextTable::Align::kLeft;
  TextTable table(columns);
  for (const GateCheck& check : result.checks) table.add_row(cells_of(check));
  return fmt::format("{}\n{}\n", table.str(), fmt::join(notes_of(result), "\n"));
}

std::string gate_markdown(const GateResult& result, std::string_view unlike) {
  std::string text = fmt::format("### MOS gate: {}\n\n{}|---|--:|--:|--:|--:|--:|--:|---|\n",
                                 result.passed() ? "pass" : "REGRESSION", markdown_row(kColumns));
  for (const GateCheck& check : result.checks) text += markdown_row(cells_of(check));
  for (const std::string& note : notes_of(result))
    text += fmt::format("\n{}\n", markdown_text(note));
  if (!unlike.empty()) text += fmt::format("\nunlike: {}\n", markdown_text(unlike));
  return text;
}

std::string gate_annotations(const GateResult& result) {
  std::string text;
  for (const GateCheck& check : result.checks) {
    if (check.passed) continue;
    const std::string now =
        check.newer ? fmt::format("{} % now: {} points, tolerance {}", percent_text(check.newer),
                                  percent_text(check.difference.value, "{:+.2f}"),
                                  percent_text(check.tolerance, "{:.2f}"))
                    : "undefined now";
    text += fmt::format("::error title={}::{}\n",
                        workflow_text(fmt::format("IoU of {} dropped", check.name), ":,"),
                        workflow_text(percent_text(check.baseline) + " % before, " + now));
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
