#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/report/report.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/study/study_table.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// "62.3 +- 1.2".
std::string mean_text(const StudyMean& mean) {
  if (!mean.value) return mean.seeds == 0 ? "-" : "undefined";
  if (!mean.interval) return percent_text(mean.value);
  // One end may be cut.
  const double half = std::max(mean.interval->high - *mean.value, *mean.value - mean.interval->low);
  return fmt::format("{} +- {:.1f}", percent_text(mean.value), 100 * half);
}

Sheet overview_sheet(const StudyTable& table) {
  Sheet sheet{.title = table.name,
              .columns = {{"method", Unit::kText},
                          {"IoU %"},
                          {"to best"},
                          {"precision %"},
                          {"recall %"},
                          {"ms/scan", Unit::kNumber, 1},
                          {"front"},
                          {"rank", Unit::kNumber, 2}}};
  for (const StudyRow& row : table.rows) {
    sheet.rows.push_back({row.label, mean_text(row.metrics[0]),
                          row.to_best ? mean_text(*row.to_best) : "", mean_text(row.metrics[1]),
                          mean_text(row.metrics[2]), or_missing(row.ms_per_scan),
                          row.is_on_front ? "*" : "", or_missing(row.rank)});
    sheet.row_standing.push_back({table.simulated, "", row.doubts});
  }
  return sheet;
}

Sheet curve_sheet(const StudyTable& table, const StudyCurve& curve) {
  const bool has_unit = !curve.unit.empty() && curve.unit != "1";  // as of a probability
  const std::string title = has_unit ? fmt::format("{}, {}", curve.axis, curve.unit) : curve.axis;
  Sheet sheet{.columns = {{fmt::format("IoU % by {}", title), Unit::kText}}};
  for (const std::string& value : curve.values) sheet.columns.push_back({value});
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    std::vector<Cell>& row = sheet.rows.emplace_back(1, table.rows[i].label);
    for (const StudyMetrics& metrics : curve.metrics[i]) row.emplace_back(mean_text(metrics[0]));
  }
  return sheet;
}

/// A line per combination of settings.
Sheet grid_sheet(const StudyTable& table, const StudyCurve& curve) {
  const std::string where = table.choices.empty() ? "grid" : "grid, on tune_on";
  Sheet sheet{.columns = {{"IoU % by " + where, Unit::kText}}};
  for (const StudyRow& row : table.rows) sheet.columns.push_back({row.label});
  for (std::size_t value = 0; value < curve.values.size(); ++value) {
    std::vector<Cell>& row = sheet.rows.emplace_back(1, curve.values[value]);
    for (const auto& line : curve.metrics) row.emplace_back(mean_text(line[value][0]));
  }
  return sheet;
}

std::string part_text(const std::optional<StudyMetrics>& metrics, std::size_t metric) {
  return metrics ? mean_text((*metrics)[metric]) : "-";
}

/// Two lines per row: the settings that were chosen, and the preset without them.
Sheet choices_sheet(const StudyTable& table) {
  Sheet sheet{.columns = {{"best of the grid", Unit::kText}, {"settings", Unit::kText}}};
  for (const char* part : {"tuned", "judged"}) {
    for (const Metric metric : kBriefMetrics) {
      sheet.columns.push_back({fmt::format("{} {} %", part, row_of(metric).title)});
    }
  }
  const auto add = [&](const std::string& label, const std::string& settings,
                       const TunedAndJudged& numbers) {
    std::vector<Cell>& row = sheet.rows.emplace_back(std::vector<Cell>{label, settings});
    for (const auto* part : {&numbers.tuned, &numbers.judged}) {
      for (std::size_t i = 0; i < kBriefMetrics.size(); ++i) row.emplace_back(part_text(*part, i));
    }
  };
  for (const StudyChoice& choice : table.choices) {
    const bool has_one = choice.preset.has_value();
    add(choice.label, has_one ? to_words(choice.preset->settings) : "none: " + choice.why_none,
        choice.chosen);
    add("", table.unchanged, choice.base);
  }
  return sheet;
}

void add_choice_notes(const StudyTable& table, std::vector<std::string>& notes) {
  if (table.choices.empty()) return;
  notes.push_back(
      "settings are chosen by tuned alone, the first of equals; judged is what they are worth "
      "elsewhere");
  for (const StudyChoice& choice : table.choices) {
    if (choice.preset) {
      notes.push_back(fmt::format("`mosbench run DATA --preset {}`: {}",
                                  shell_word(choice.preset->file.string()),
                                  choice.preset->words()));
    }
    if (choice.passed_over > 0) {
      notes.push_back(fmt::format("{}: {} of {} passed over, because they fail or lack the metric",
                                  choice.label, choice.passed_over,
                                  counted(choice.candidates, "combination")));
    }
  }
}

/// A line per sampled setting with its effect on the IoU of each method.
Sheet effects_sheet(const StudyTable& table) {
  Sheet sheet{.columns = {{"total effect", Unit::kText}}};
  for (const StudyEffects& effects : table.effects) sheet.columns.push_back({effects.label});
  for (std::size_t column = 0; column < table.effects.size(); ++column) {
    const StudyEffects& effects = table.effects[column];
    for (std::size_t i = 0; i < effects.settings.size(); ++i) {
      const Cell name = effects.settings[i];
      auto row = std::ranges::find(sheet.rows, name,
                                   [](const std::vector<Cell>& cells) { return cells.front(); });
      if (row == sheet.rows.end()) {
        row = sheet.rows.insert(row, std::vector<Cell>(sheet.columns.size(), std::string()));
        row->front() = name;
      }
      const auto& effect = effects.effects[i];
      (*row)[column + 1] = effect ? fmt::format("{:.2f} ({:.2f} to {:.2f})", effect->index,
                                                effect->interval.low, effect->interval.high)
                                  : "-";
    }
  }
  return sheet;
}

/// "36 of 36 cells are done; they took 12 s of one core, 1.20 times the 10 s that were expected".
std::string work_done_text(const StudyTable& table) {
  std::string text = fmt::format("{} of {} done; {} took {} of one core", table.done,
                                 counted(table.cells, "cell is", "cells are"),
                                 table.cells == 1 ? "it" : "they", duration_text(*table.core_s));
  if (!table.predicted_s || *table.predicted_s <= 0) return text;
  return text + fmt::format(", {:.2f} times the {} that were expected",
                            *table.core_s / *table.predicted_s, duration_text(*table.predicted_s));
}

/// Adds a line per reason: a bad scan fails every cell of its sequence.
void add_gaps(const std::vector<StudyGap>& gaps, std::vector<std::string>& notes) {
  std::vector<std::string> reasons;
  std::map<std::string, std::vector<std::string>> cells;
  for (const StudyGap& gap : gaps) {
    if (cells[gap.why].empty()) reasons.push_back(gap.why);
    cells[gap.why].push_back(gap.title);
  }
  for (const std::string& why : reasons) {
    const std::vector<std::string>& same = cells[why];
    const std::string more =
        same.size() == 1 ? "" : " and " + counted(same.size() - 1, "more cell");
    notes.push_back(fmt::format("{}{}: {}", same.front(), more, why));
  }
}

std::vector<std::string> notes_of(const StudyTable& table) {
  std::vector<std::string> notes;
  if (table.rule) notes.push_back(rule_line(*table.rule));
  notes.insert(
      notes.end(),
      {"+- is half of the 95 % interval: where many more scans like these would be, as `mosbench",
       "rank` says it; with several seeds their spread, of fewer than three there is none",
       "\"to best\" is the paired difference of IoU", "results in " + table.out});
  for (const StudyEffects& effects : table.effects) {
    notes.push_back(fmt::format(
        "total effect on {}: the part of the IoU's variance that is left while all other sampled "
        "settings are fixed, over {} points (Jansen; 95 % by bootstrap)",
        effects.label, effects.points));
  }
  if (table.critical_difference) {
    notes.push_back(fmt::format(
        "Mean ranks over {} sequences, each by the mean IoU over all disturbances, differ at 5 % "
        "where they are more than {:.2f} apart (Nemenyi).",
        table.ranked_sequences, *table.critical_difference));
  }
  if (table.core_s) notes.push_back(work_done_text(table));
  add_choice_notes(table, notes);
  add_gaps(table.undefined, notes);
  add_gaps(table.failures, notes);
  add_gaps(table.missing, notes);
  return notes;
}

ordered_json to_json(const StudyMean& mean) {
  ordered_json json = {{"value", json_or_null(mean.value)}, {"seeds", mean.seeds}};
  json.update(interval_json(spread_of(mean)));
  return json;
}

ordered_json to_json(const StudyMetrics& metrics) {
  ordered_json json;
  for (std::size_t i = 0; i < metrics.size(); ++i)
    json[std::string(row_of(kBriefMetrics[i]).key)] = to_json(metrics[i]);
  return json;
}

ordered_json to_json(const StudyEffects& effects) {
  ordered_json settings = ordered_json::array();
  for (std::size_t i = 0; i < effects.settings.size(); ++i) {
    ordered_json& one = settings.emplace_back(ordered_json{{"name", effects.settings[i]}});
    const std::optional<TotalEffect>& effect = effects.effects[i];
    one["total_effect"] = effect ? ordered_json(effect->index) : ordered_json();
    if (!effect) continue;
    one["low"] = effect->interval.low;
    one["high"] = effect->interval.high;
  }
  return {{"label", effects.label}, {"points", effects.points}, {"settings", settings}};
}

ordered_json to_json(const TunedAndJudged& numbers) {
  const auto part = [](const std::optional<StudyMetrics>& metrics) {
    return metrics ? to_json(*metrics) : ordered_json();
  };
  return {{"tuned", part(numbers.tuned)}, {"judged", part(numbers.judged)}};
}

ordered_json to_json(const StudyChoice& choice) {
  ordered_json json = {{"label", choice.label},
                       {"preset_file", nullptr},
                       {"preset", nullptr},
                       {"why_none", choice.why_none},
                       {"combinations", choice.candidates},
                       {"passed_over", choice.passed_over},
                       {"chosen", to_json(choice.chosen)},
                       {"base", to_json(choice.base)}};
  if (!choice.preset) return json;
  json["preset_file"] = choice.preset->file.string();
  json["preset"] = to_json(*choice.preset);
  return json;
}

Cell cell_number(const PlannedCell& planned, const std::optional<double>& number) {
  return planned.state == CellState::kDone ? or_missing(number) : Cell();
}

/// A row per cell.
Sheet records_of(const StudyPlan& plan) {
  Sheet sheet;
  for (const char* name : {"key", "data", "group", "sequence", "method", "odometry", "axis",
                           "value", "seed", "state", "protocol", "min_range_m", "max_range_m",
                           "iou", "precision", "recall", "ms_per_scan", "wall_s", "why"}) {
    sheet.columns.push_back({name});
  }
  const std::optional<ScoreRule>& rule = plan.rule;
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    const CellNumbers& numbers = planned.numbers;
    sheet.row_standing.push_back({numbers.simulated, "", numbers.doubts});
    sheet.rows.push_back(
        {cell.key, cell.data->name, cell.data->group, cell.sequence, cell.method->name,
         cell.odometry, cell.axis == nullptr ? "" : cell.axis->name, cell.value,
         std::uint64_t{cell.seed}, std::string(to_string(planned.state)),
         rule ? std::string(rule->protocol->name) : "",
         rule ? Cell(double{rule->range.min_m}) : Cell(),
         rule ? Cell(double{rule->range.max_m}) : Cell(), cell_number(planned, numbers.metrics[0]),
         cell_number(planned, numbers.metrics[1]), cell_number(planned, numbers.metrics[2]),
         cell_number(planned, numbers.ms_per_scan), cell_number(planned, numbers.wall_s),
         planned.state == CellState::kFailed ? planned.failure : why_undefined(planned)});
  }
  return sheet;
}

ordered_json gaps_json(const std::vector<StudyGap>& gaps) {
  ordered_json json = ordered_json::array();
  for (const StudyGap& gap : gaps) json.push_back({{"cell", gap.title}, {"why", gap.why}});
  return json;
}

}  // namespace

ordered_json to_json(const StudyTable& table) {
  ordered_json json = {{"name", table.name},
                       {"version", std::string(kMosbenchVersion)},
                       {"simulated", table.simulated},
                       {"doubts", table.doubts},
                       {"protocol", nullptr},
                       {"min_range_m", nullptr},
                       {"max_range_m", nullptr},
                       {"cells", table.cells},
                       {"done", table.done},
                       {"cpu_s", json_or_null(table.core_s)},
                       {"predicted_cpu_s", json_or_null(table.predicted_s)},
                       {"ranked_sequences", table.ranked_sequences},
                       {"critical_difference", json_or_null(table.critical_difference)},
                       {"rows", ordered_json::array()},
                       {"curves", ordered_json::array()},
                       {"effects", ordered_json::array()},
                       {"choices", ordered_json::array()},
                       {"worst", ordered_json::array()},
                       {"missing", gaps_json(table.missing)},
                       {"undefined", gaps_json(table.undefined)},
                       {"failures", gaps_json(table.failures)}};
  if (table.rule) json.update(rule_json(*table.rule));
  for (const StudyRow& row : table.rows) {
    json["rows"].push_back({{"label", row.label},
                            {"metrics", to_json(row.metrics)},
                            {"to_best", row.to_best ? to_json(*row.to_best) : ordered_json()},
                            {"ms_per_scan", json_or_null(row.ms_per_scan)},
                            {"front", row.is_on_front},
                            {"rank", json_or_null(row.rank)}});
  }
  for (const StudyCurve& curve : table.curves) {
    ordered_json lines = ordered_json::array();
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      ordered_json points = ordered_json::array();
      for (const StudyMetrics& metrics : curve.metrics[i]) points.push_back(to_json(metrics));
      lines.push_back({{"label", table.rows[i].label}, {"points", points}});
    }
    json["curves"].push_back(
        {{"axis", curve.axis}, {"unit", curve.unit}, {"values", curve.values}, {"lines", lines}});
  }
  for (const StudyEffects& effects : table.effects) {
    json["effects"].push_back(to_json(effects));
  }
  for (const StudyChoice& choice : table.choices) json["choices"].push_back(to_json(choice));
  for (const StudyWorst& scan : table.worst) {
    json["worst"].push_back({{"label", scan.label},
                             {"cell", scan.title},
                             {"stem", scan.stem},
                             {"iou", scan.iou},
                             {"command", scan.command}});
  }
  return json;
}

Answer study_answer(const StudyPlan& plan, const StudyTable& table) {
  const ordered_json json = to_json(table);
  Answer answer{.exit_code = table.done == table.cells ? 0 : 1,
                .standing = Standing{table.simulated, "", table.doubts},
                .sheets = {overview_sheet(table)},
                .records = records_of(plan),
                .json = json_text(json),
                .page = filled_page(study_asset(), json)};
  std::string caption = table.rule ? "protocol " + rule_name(*table.rule) : "";
  if (answer.exit_code != 0) {
    answer.standing->doubts.push_back(fmt::format(
        "INCOMPLETE: {} missing", counted(table.cells - table.done, "cell is", "cells are")));
    caption += (caption.empty() ? "" : "; ") + answer.standing->doubts.back();
  }
  for (const StudyCurve& curve : table.curves) {
    answer.sheets.push_back(curve.is_grid ? grid_sheet(table, curve) : curve_sheet(table, curve));
  }
  if (!table.choices.empty()) answer.sheets.push_back(choices_sheet(table));
  if (!table.effects.empty()) answer.sheets.push_back(effects_sheet(table));
  for (Sheet& sheet : answer.sheets) sheet.caption = caption;
  answer.sheets.back().notes = notes_of(table);
  return answer;
}

}  // namespace mosbench
