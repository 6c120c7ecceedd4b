#include "eval/tables/leaderboard_print.hpp"

#include <fmt/format.h>

#include <map>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/csv.hpp"
#include "eval/answer/latex.hpp"
#include "eval/answer/markdown.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/protocol_list.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::string percent_of(const std::optional<Estimates>& estimates, Metric metric) {
  return estimates ? percent_text((*estimates)[metric].value) : "-";
}

std::string number_text(const std::optional<double>& number) {
  return number ? fmt::format("{:.1f}", *number) : "-";
}

/// "-2.1 [-3.0, -1.2]", "-2.1 [none]", "first" or "-".
std::string to_first_text(const Leaderboard& board, const LeaderboardRow& row) {
  if (&row == &board.rows.front()) return row.all ? "first" : "-";
  if (!row.to_first) return "-";
  const std::string value = percent_text(row.to_first->value, "{:+.2f}");
  const std::string interval = interval_text(row.to_first->interval, "{:+.2f}");
  return fmt::format("{} {}", value, interval == "none" ? "[none]" : interval);
}

/// `missing` where the run has no such setting.
std::string value_text(const ordered_json& value, const char* missing) {
  if (value.is_null()) return missing;
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// A sequence's own column would repeat that of all where there is but one.
bool shows_sequences(const Leaderboard& board) { return board.sequences.size() > 1; }

std::vector<TextTable::Column> columns_of(const Leaderboard& board) {
  std::vector<TextTable::Column> columns = {{"", TextTable::kLeft}, {"method", TextTable::kLeft}};
  for (const DifferingSetting& setting : board.differing) columns.push_back({setting.name});
  columns.insert(columns.end(), {{"IoU %"}, {"95 %"}});
  if (shows_sequences(board)) {
    for (const std::string& name : board.sequences) columns.push_back({name});
  }
  for (const char* title : {"precision %", "recall %", "ms/scan", "MB", "front", "IoU to first"}) {
    columns.push_back({title});
  }
  return columns;
}

std::vector<std::string> cells_of_row(const Leaderboard& board, std::size_t r) {
  const LeaderboardRow& row = board.rows[r];
  std::vector<std::string> cells = {fmt::format("{}", r + 1), row.run->front().method};
  for (const DifferingSetting& setting : board.differing) {
    cells.push_back(value_text(setting.values[r], "-"));
  }
  cells.push_back(percent_of(row.all, Metric::kIou));
  cells.push_back(row.all ? interval_text((*row.all)[Metric::kIou].interval, "{:.1f}") : "-");
  if (shows_sequences(board)) {
    for (const auto& estimates : row.sequences) {
      cells.push_back(percent_of(estimates, Metric::kIou));
    }
  }
  for (const Metric metric : {Metric::kPrecision, Metric::kRecall}) {
    cells.push_back(percent_of(row.all, metric));
  }
  cells.push_back(number_text(row.ms_per_scan));
  cells.push_back(number_text(row.memory_mb));
  cells.emplace_back(row.is_on_front ? "*" : "");
  cells.push_back(to_first_text(board, row));
  return cells;
}

std::string rules_text(const Leaderboard& board) {
  const SequenceResult& first = board.rows.front().run->front();
  const std::string range = counted_range_text(*first.protocol, first.range);
  return fmt::format("data set {}, protocol {}{}{}", first.dataset, first.protocol->name,
                     range.empty() ? "" : ", " + range,
                     first.simulated ? "; SIMULATED: not comparable with published numbers" : "");
}

/// Says per row which run it is, and per reason which differences have no interval.
std::string row_notes(const Leaderboard& board) {
  std::string text;
  std::map<std::string, std::vector<std::size_t>> without_interval;
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    const LeaderboardRow& row = board.rows[r];
    text += fmt::format("{}: {}, {} ({})\n", r + 1, row.run->front().method,
                        row.run->front().setting, row.run->front().file.string());
    if (!row.to_first || row.to_first->no_interval.empty()) continue;
    without_interval[row.to_first->no_interval].push_back(r + 1);
  }
  for (const auto& [why, rows] : without_interval) {
    text += fmt::format("no interval of the difference of {}: {}\n", fmt::join(rows, ", "), why);
  }
  return text;
}

std::string remarks_text(const Leaderboard& board) {
  std::string text;
  for (const std::string& remark : board.remarks) text += remark + '\n';
  return text;
}

std::size_t place_of(const Leaderboard& board, const LeaderboardRow& row) {
  return static_cast<std::size_t>(&row - board.rows.data());
}

std::string csv_number(const std::optional<double>& number) {
  return number ? fmt::format("{:.6g}", *number) : "";
}

/// Value, low and high.
void add_csv(const Estimate& estimate, std::vector<std::string>& cells) {
  cells.push_back(csv_percent(estimate.value));
  const auto& interval = estimate.interval;
  cells.push_back(interval ? csv_percent(interval->low) : "");
  cells.push_back(interval ? csv_percent(interval->high) : "");
}

std::string csv_line(const Leaderboard& board, const LeaderboardRow& row,
                     const std::string& sequence, const std::optional<Estimates>& estimates) {
  const SequenceResult& first = row.run->front();
  std::vector<std::string> cells = {first.method, first.setting, first.file.string(), sequence};
  for (const Metric metric : {Metric::kIou, Metric::kPrecision, Metric::kRecall}) {
    add_csv(estimates ? (*estimates)[metric] : Estimate{}, cells);
  }
  const bool is_all = sequence == "all";
  cells.push_back(is_all ? csv_number(row.ms_per_scan) : "");
  cells.push_back(is_all ? csv_number(row.memory_mb) : "");
  cells.emplace_back(is_all && row.is_on_front ? "1" : "");
  const Difference to_first = is_all ? row.to_first.value_or(Difference{}) : Difference{};
  add_csv(to_first, cells);
  cells.push_back(csv_number(to_first.p_value));
  cells.push_back(to_first.no_interval);
  for (const DifferingSetting& setting : board.differing) {
    cells.push_back(value_text(setting.values[place_of(board, row)], ""));
  }
  return csv_row(cells);
}

ordered_json to_json(const Leaderboard& board, const LeaderboardRow& row) {
  ordered_json json = provenance_json(*row.run);
  json["differing_settings"] = ordered_json::object();
  for (const DifferingSetting& setting : board.differing) {
    json["differing_settings"][setting.name] = setting.values[place_of(board, row)];
  }
  json["all"] = row.all ? to_json(*row.all) : ordered_json(nullptr);
  json["sequences"] = ordered_json::array();
  for (std::size_t s = 0; s < board.sequences.size(); ++s) {
    json["sequences"].push_back(
        {{"name", board.sequences[s]},
         {"metrics", row.sequences[s] ? to_json(*row.sequences[s]) : ordered_json(nullptr)}});
  }
  json["ms_per_scan"] = json_or_null(row.ms_per_scan);
  json["memory_mb"] = json_or_null(row.memory_mb);
  json["on_front"] = row.is_on_front;
  json["to_first"] = nullptr;
  if (row.to_first) json["to_first"] = to_json(*row.to_first);
  return json;
}

}  // namespace

std::string leaderboard_text(const Leaderboard& board) {
  TextTable table(columns_of(board));
  for (std::size_t r = 0; r < board.rows.size(); ++r) table.add_row(cells_of_row(board, r));
  return fmt::format(
      "{}\n\n{}\n* front: no other run is as good and as fast, and better in one of both\n"
      "to first: paired difference of IoU in percentage points, with its 95 % interval\n\n{}{}",
      rules_text(board), table.str(), row_notes(board), remarks_text(board));
}

std::string leaderboard_latex(const Leaderboard& board) {
  std::string text = "% " + latex_text(rules_text(board)) + '\n';
  for (const std::string& remark : board.remarks) text += "% " + latex_text(remark) + '\n';
  std::vector<std::string> titles;
  for (const TextTable::Column& column : columns_of(board)) titles.push_back(column.title);
  text += fmt::format("\\begin{{tabular}}{{rl{}}}\n", std::string(titles.size() - 2, 'r'));
  text += latex_row(titles) + "\\hline\n";
  for (std::size_t r = 0; r < board.rows.size(); ++r) text += latex_row(cells_of_row(board, r));
  return text + "\\end{tabular}\n";
}

std::string leaderboard_markdown(const Leaderboard& board) {
  std::vector<std::string> titles;
  std::string rule = "|";
  for (const TextTable::Column& column : columns_of(board)) {
    titles.push_back(column.title);
    rule += column.align == TextTable::kLeft ? "---|" : "--:|";
  }
  std::string text = markdown_text(rules_text(board)) + "\n\n" + markdown_row(titles) + rule + '\n';
  for (std::size_t r = 0; r < board.rows.size(); ++r) text += markdown_row(cells_of_row(board, r));
  text += "\n\\*: no other run is as good and as fast, and better in one of both\n";
  for (const std::string& remark : board.remarks) text += "\n" + markdown_text(remark) + '\n';
  return text;
}

std::string leaderboard_csv(const Leaderboard& board) {
  std::vector<std::string> titles = {"method",
                                     "setting",
                                     "results",
                                     "sequence",
                                     "iou_percent",
                                     "iou_low_percent",
                                     "iou_high_percent",
                                     "precision_percent",
                                     "precision_low_percent",
                                     "precision_high_percent",
                                     "recall_percent",
                                     "recall_low_percent",
                                     "recall_high_percent",
                                     "ms_per_scan",
                                     "memory_mb",
                                     "on_front",
                                     "to_first_points",
                                     "to_first_low_points",
                                     "to_first_high_points",
                                     "to_first_p_value",
                                     "no_interval"};
  for (const DifferingSetting& setting : board.differing) titles.push_back(setting.name);
  std::string csv = csv_row(titles);
  for (const LeaderboardRow& row : board.rows) {
    csv += csv_line(board, row, "all", row.all);
    for (std::size_t s = 0; s < board.sequences.size(); ++s) {
      csv += csv_line(board, row, board.sequences[s], row.sequences[s]);
    }
  }
  return csv;
}

ordered_json to_json(const Leaderboard& board) {
  const SequenceResult& first = board.rows.front().run->front();
  ordered_json json = {
      {"dataset", first.dataset},         {"protocol", std::string(first.protocol->name)},
      {"min_range_m", first.range.min_m}, {"max_range_m", first.range.max_m},
      {"simulated", first.simulated},     {"confidence", kConfidence},
      {"sequences", board.sequences},     {"differing_settings", ordered_json::array()},
      {"rows", ordered_json::array()},    {"remarks", board.remarks}};
  for (const DifferingSetting& setting : board.differing) {
    json["differing_settings"].push_back(setting.name);
  }
  for (const LeaderboardRow& row : board.rows) json["rows"].push_back(to_json(board, row));
  return json;
}

}  // namespace mosbench
