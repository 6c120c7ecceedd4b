#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "datasets/text/counted.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/csv.hpp"
#include "eval/answer/latex.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/protocol_list.hpp"
#include "eval/report/report_asset.hpp"
#include "eval/results/progress.hpp"
#include "eval/results/version.hpp"
#include "eval/study/study_table.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// "62.3 +- 1.2".
std::string mean_text(const StudyMean& mean) {
  if (!mean.value) return mean.count == 0 ? "-" : "undefined";
  if (!mean.interval) return percent_text(mean.value);
  return fmt::format("{} +- {:.1f}", percent_text(mean.value), 100 * mean.half_width);
}

std::string number_text(const std::optional<double>& value, const char* style) {
  return value ? fmt::format(fmt::runtime(style), *value) : "-";
}

/// Lines of cells, the first of which is the head.
using TextRows = std::vector<std::vector<std::string>>;

TextRows overview_rows(const StudyTable& table) {
  TextRows rows = {
      {"method", "IoU %", "to best", "precision %", "recall %", "ms/scan", "front", "rank"}};
  for (const StudyRow& row : table.rows) {
    rows.push_back({row.label, mean_text(row.metrics[0]),
                    row.to_best ? mean_text(*row.to_best) : "", mean_text(row.metrics[1]),
                    mean_text(row.metrics[2]), number_text(row.ms_per_scan, "{:.1f}"),
                    row.is_on_front ? "*" : "", number_text(row.rank, "{:.2f}")});
  }
  return rows;
}

std::string axis_title(const StudyCurve& curve) {
  const bool has_unit = !curve.unit.empty() && curve.unit != "1";  // as of a probability
  return has_unit ? fmt::format("{}, {}", curve.axis, curve.unit) : curve.axis;
}

TextRows curve_rows(const StudyTable& table, const StudyCurve& curve, const std::string& title) {
  TextRows rows = {{title}};
  rows.front().insert(rows.front().end(), curve.values.begin(), curve.values.end());
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    std::vector<std::string>& row = rows.emplace_back(1, table.rows[i].label);
    for (const StudyMetrics& metrics : curve.metrics[i]) row.push_back(mean_text(metrics[0]));
  }
  return rows;
}

std::string effect_text(const std::optional<TotalEffect>& effect) {
  if (!effect) return "-";
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", effect->index, effect->interval.low,
                     effect->interval.high);
}

/// A line per sampled setting with its effect on the IoU of each method.
TextRows effect_rows(const StudyTable& table) {
  TextRows rows = {{"total effect"}};
  for (const StudyEffects& effects : table.effects) rows.front().push_back(effects.label);
  for (std::size_t column = 0; column < table.effects.size(); ++column) {
    const StudyEffects& effects = table.effects[column];
    for (std::size_t i = 0; i < effects.settings.size(); ++i) {
      auto row = std::ranges::find(rows, effects.settings[i],
                                   [](const std::vector<std::string>& each) { return each[0]; });
      if (row == rows.end()) {
        row = rows.insert(row, std::vector<std::string>(rows.front().size(), ""));
        row->front() = effects.settings[i];
      }
      (*row)[column + 1] = effect_text(effects.effects[i]);
    }
  }
  return rows;
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

/// A line per reason: a bad scan fails every cell of its sequence.
std::string gaps_text(const std::vector<StudyGap>& gaps) {
  std::vector<std::string> reasons;
  std::map<std::string, std::vector<std::string>> cells;
  for (const StudyGap& gap : gaps) {
    if (cells[gap.why].empty()) reasons.push_back(gap.why);
    cells[gap.why].push_back(gap.title);
  }
  std::string text;
  for (const std::string& why : reasons) {
    const std::vector<std::string>& same = cells[why];
    const std::string more =
        same.size() == 1 ? "" : " and " + counted(same.size() - 1, "more cell");
    text += fmt::format("{}{}: {}\n", same.front(), more, why);
  }
  return text;
}

std::string remarks_text(const StudyTable& table) {
  std::string text = table.rule ? rule_line(*table.rule) + '\n' : "";
  text +=
      "+- is half of the 95 % interval of the mean over sequences, each the mean of its seeds, or\n"
      "over the seeds of one; of fewer than three there is none\n"
      "\"to best\" is the paired difference of IoU\n";
  text += fmt::format("results in {}\n", table.out);
  for (const StudyEffects& effects : table.effects) {
    text += fmt::format(
        "total effect on {}: the part of the IoU's variance that is left while all other sampled "
        "settings are fixed, over {} points (Jansen; 95 % by bootstrap)\n",
        effects.label, effects.points);
  }
  if (table.critical_difference) {
    text += fmt::format(
        "Mean ranks over {} sequences, each by the mean IoU over all disturbances, differ at 5 % "
        "where they are more than {:.2f} apart (Nemenyi).\n",
        table.ranked_sequences, *table.critical_difference);
  }
  if (table.simulated) text += "simulated data: not comparable with published numbers\n";
  if (table.core_s) text += fmt::format("{}\n", work_done_text(table));
  if (table.done < table.cells) {
    text += fmt::format("INCOMPLETE: {} missing\n",
                        counted(table.cells - table.done, "cell is", "cells are"));
  }
  return text + gaps_text(table.undefined) + gaps_text(table.failures);
}

ordered_json to_json(const StudyMean& mean) {
  ordered_json json = {{"value", json_or_null(mean.value)}, {"count", mean.count}};
  if (mean.interval) {
    json["low"] = mean.interval->low;
    json["high"] = mean.interval->high;
  }
  return json;
}

ordered_json to_json(const StudyMetrics& metrics) {
  ordered_json json;
  for (std::size_t i = 0; i < metrics.size(); ++i) json[kStudyMetrics[i]] = to_json(metrics[i]);
  return json;
}

ordered_json to_json(const StudyEffects& effects) {
  ordered_json settings = ordered_json::array();
  for (std::size_t i = 0; i < effects.settings.size(); ++i) {
    ordered_json& one = settings.emplace_back(ordered_json{{"name", effects.settings[i]}});
    const std::optional<TotalEffect>& effect = effects.effects[i];
    one["total_effect"] = effect ? ordered_json(effect->index) : ordered_json(nullptr);
    if (!effect) continue;
    one["low"] = effect->interval.low;
    one["high"] = effect->interval.high;
  }
  return {{"label", effects.label}, {"points", effects.points}, {"settings", settings}};
}

std::string text_table(const TextRows& rows) {
  std::vector<TextTable::Column> columns;
  for (const std::string& title : rows.front()) columns.push_back({title});
  columns.front().align = TextTable::kLeft;
  TextTable text(columns);
  for (std::size_t i = 1; i < rows.size(); ++i) text.add_row(rows[i]);
  return text.str();
}

/// `foot` is the last line, across all columns.
std::string latex_table(const TextRows& rows, const std::string& foot) {
  const std::size_t columns = rows.front().size();
  std::string text =
      fmt::format("\\begin{{tabular}}{{l{}}}\n\\hline\n", std::string(columns - 1, 'r'));
  text += latex_row(rows.front()) + "\\hline\n";
  for (std::size_t i = 1; i < rows.size(); ++i) text += latex_row(rows[i]);
  text += "\\hline\n";
  if (!foot.empty()) {
    text += fmt::format("\\multicolumn{{{}}}{{l}}{{{}}} \\\\\n", columns, latex_text(foot));
  }
  return text + "\\end{tabular}\n";
}

std::string cell_number(const PlannedCell& planned, const char* part, const char* what) {
  if (planned.state != CellState::kDone) return "";
  const auto value = number_in(planned.record, part, what);
  return value ? ordered_json(*value).dump() : "";
}

/// Protocol, lowest and highest range.
std::vector<std::string> csv_rule(const std::optional<ScoreRule>& rule) {
  if (!rule) return {"", "", ""};
  return {std::string(rule->protocol->name), fmt::format("{}", rule->range.min_m),
          fmt::format("{}", rule->range.max_m)};
}

std::string why_empty(const PlannedCell& planned) {
  return planned.state == CellState::kFailed ? planned.record.value("failure", "")
                                             : why_undefined(planned);
}

ordered_json gaps_json(const std::vector<StudyGap>& gaps) {
  ordered_json json = ordered_json::array();
  for (const StudyGap& gap : gaps) json.push_back({{"cell", gap.title}, {"why", gap.why}});
  return json;
}

}  // namespace

std::string study_text(const StudyTable& table) {
  std::string text = fmt::format("{}\n\n{}", table.name, text_table(overview_rows(table)));
  for (const StudyCurve& curve : table.curves) {
    const std::string title = fmt::format("IoU % by {}", axis_title(curve));
    text += "\n" + text_table(curve_rows(table, curve, title));
  }
  if (!table.effects.empty()) text += "\n" + text_table(effect_rows(table));
  return text + "\n" + remarks_text(table);
}

std::string study_latex(const StudyTable& table) {
  std::string text;
  if (table.simulated) text += "% simulated data: not comparable with published numbers\n";
  const std::string rule = table.rule ? "protocol " + rule_name(*table.rule) : "";
  text += latex_table(overview_rows(table), rule);
  for (const StudyCurve& curve : table.curves) {
    text += "\n" + latex_table(curve_rows(table, curve, axis_title(curve)), rule);
  }
  if (!table.effects.empty()) text += "\n" + latex_table(effect_rows(table), rule);
  return text;
}

std::string study_csv(const StudyPlan& plan) {
  std::string text = csv_row(
      std::vector<std::string>{"key", "data", "group", "sequence", "method", "odometry", "axis",
                               "value", "seed", "state", "protocol", "min_range_m", "max_range_m",
                               "iou", "precision", "recall", "ms_per_scan", "wall_s", "why"});
  const std::vector<std::string> rule = csv_rule(plan.rule);
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    text += csv_row(std::vector<std::string>{
        cell.key, cell.data->name, cell.data->group, cell.sequence, cell.method->name,
        cell.odometry, cell.axis == nullptr ? "" : cell.axis->name, cell.value,
        std::to_string(cell.seed), std::string(to_string(planned.state)), rule[0], rule[1], rule[2],
        cell_number(planned, "summary", "iou"), cell_number(planned, "summary", "precision"),
        cell_number(planned, "summary", "recall"), cell_number(planned, "timing", "ms_per_scan"),
        cell_number(planned, "timing", "wall_s"), why_empty(planned)});
  }
  return text;
}

ordered_json to_json(const StudyTable& table) {
  ordered_json json = {{"name", table.name},
                       {"version", std::string(kMosbenchVersion)},
                       {"simulated", table.simulated},
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
                       {"worst", ordered_json::array()},
                       {"undefined", gaps_json(table.undefined)},
                       {"failures", gaps_json(table.failures)}};
  if (table.rule) {
    json["protocol"] = table.rule->protocol->name;
    json["min_range_m"] = table.rule->range.min_m;
    json["max_range_m"] = table.rule->range.max_m;
  }
  for (const StudyRow& row : table.rows) {
    json["rows"].push_back(
        {{"label", row.label},
         {"metrics", to_json(row.metrics)},
         {"to_best", row.to_best ? to_json(*row.to_best) : ordered_json(nullptr)},
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
  for (const StudyWorst& scan : table.worst) {
    json["worst"].push_back({{"label", scan.label},
                             {"cell", scan.title},
                             {"stem", scan.stem},
                             {"iou", scan.iou},
                             {"command", scan.command}});
  }
  return json;
}

std::string study_html(const StudyTable& table) {
  return filled_page(study_asset(), to_json(table));
}

}  // namespace mosbench
