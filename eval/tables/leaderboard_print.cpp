#include <fmt/format.h>

#include <map>
#include <span>

#include "eval/answer/answer_text.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

Cell estimate_cell(const std::optional<Estimates>& estimates, Metric metric) {
  return estimates ? Cell(spread_of((*estimates)[metric])) : Cell();
}

/// Without its interval.
Cell value_cell(const std::optional<Estimates>& estimates, Metric metric) {
  return estimates ? or_undefined((*estimates)[metric].value) : Cell();
}

Cell to_first_cell(const Leaderboard& board, const LeaderboardRow& row) {
  if (&row == &board.rows.front()) return row.all ? Cell("first") : Cell();
  return row.to_first ? Cell(spread_of(*row.to_first)) : Cell();
}

/// Nothing where the run has no such setting.
Cell setting_cell(const std::optional<SettingValue>& value) {
  return value ? Cell(mosbench::value_text(*value)) : Cell();
}

/// A sequence's own column would repeat that of all where there is but one.
bool shows_sequences(const Leaderboard& board) { return board.sequences.size() > 1; }

std::string rules_text(const Leaderboard& board) {
  const Result& first = board.rows.front().run->front();
  const std::string range = counted_range_text(*first.protocol, first.range);
  return fmt::format("data set {}, protocol {}{}{}", first.dataset, first.protocol->name,
                     range.empty() ? "" : ", ", range);
}

/// Says per row which run it is, and per reason which differences have no interval.
std::vector<std::string> notes_of(const Leaderboard& board) {
  std::vector<std::string> notes = {
      "* front: no other run is as good and as fast, and better in one of both",
      "to first: paired difference of IoU in percentage points, with its 95 % interval"};
  std::map<std::string, std::vector<std::size_t>> without_interval;
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    const LeaderboardRow& row = board.rows[r];
    const Result& first = row.run->front();
    notes.push_back(fmt::format("{}: {} ({})", r + 1, method_words(first), first.file.string()));
    if (!row.to_first || row.to_first->no_interval.empty()) continue;
    without_interval[row.to_first->no_interval].push_back(r + 1);
  }
  for (const auto& [why, rows] : without_interval) {
    notes.push_back(
        fmt::format("no interval of the difference of {}: {}", fmt::join(rows, ", "), why));
  }
  notes.insert(notes.end(), board.remarks.begin(), board.remarks.end());
  return notes;
}

/// What is told beside IoU.
constexpr auto kBeside = std::span(kBriefMetrics).subspan<1>();

Sheet sheet_of(const Leaderboard& board) {
  Sheet sheet{.lead = {rules_text(board)},
              .columns = {{""}, {"method", Unit::kText}},
              .notes = notes_of(board)};
  for (const DifferingSetting& setting : board.differing) sheet.columns.push_back({setting.name});
  sheet.columns.push_back({std::string(row_of(Metric::kIou).title), Unit::kPercent});
  if (shows_sequences(board)) {
    for (const std::string& name : board.sequences) {
      sheet.columns.push_back({name, Unit::kPercent});
    }
  }
  for (const Metric metric : kBeside) {
    sheet.columns.push_back({std::string(row_of(metric).title), Unit::kPercent});
  }
  for (const Column& column : {Column{"ms/scan", Unit::kNumber, 1},
                               {"MB", Unit::kNumber, 1},
                               {"front"},
                               {"IoU to first", Unit::kPoints}}) {
    sheet.columns.push_back(column);
  }
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    const LeaderboardRow& row = board.rows[r];
    std::vector<Cell>& cells = sheet.rows.emplace_back();
    cells = {std::uint64_t{r + 1}, row.run->front().method};
    for (const DifferingSetting& setting : board.differing) {
      cells.push_back(setting_cell(setting.values[r]));
    }
    cells.push_back(estimate_cell(row.all, Metric::kIou));
    if (shows_sequences(board)) {
      for (const auto& estimates : row.sequences) {
        cells.push_back(value_cell(estimates, Metric::kIou));
      }
    }
    for (const Metric metric : kBeside) cells.push_back(value_cell(row.all, metric));
    cells.push_back(or_missing(row.ms_per_scan));
    cells.push_back(or_missing(row.memory_mb));
    cells.emplace_back(row.is_on_front ? "*" : "");
    cells.push_back(to_first_cell(board, row));
    sheet.row_standing.push_back(row.standing);
  }
  return sheet;
}

/// A row per run and sequence, and one for all sequences.
Sheet records_of(const Leaderboard& board) {
  Sheet sheet{.columns = {{"method", Unit::kText},
                          {"setting", Unit::kText},
                          {"results", Unit::kText},
                          {"sequence", Unit::kText}}};
  for (const Metric metric : kBriefMetrics) {
    sheet.columns.push_back({std::string(row_of(metric).key), Unit::kPercent});
  }
  for (const Column& column : {Column{"ms_per_scan"},
                               {"memory_mb"},
                               {"on_front"},
                               {"to_first", Unit::kPoints},
                               {"to_first_p_value"},
                               {"no_interval", Unit::kText}}) {
    sheet.columns.push_back(column);
  }
  for (const DifferingSetting& setting : board.differing) {
    sheet.columns.push_back({.name = setting.name, .key = setting.name});
  }
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    const LeaderboardRow& row = board.rows[r];
    const Result& first = row.run->front();
    const auto add = [&](const std::string& sequence, const std::optional<Estimates>& estimates,
                         const Standing& standing) {
      const bool is_all = &standing == &row.standing;
      const Estimates metrics = estimates.value_or(Estimates{});
      sheet.row_standing.push_back(standing);
      const Difference to_first = is_all ? row.to_first.value_or(Difference{}) : Difference{};
      std::vector<Cell>& cells = sheet.rows.emplace_back();
      cells = {first.method, first.setting, first.file.string(), sequence};
      for (const Metric metric : kBriefMetrics) cells.emplace_back(spread_of(metrics[metric]));
      cells.insert(cells.end(), {is_all ? or_missing(row.ms_per_scan) : Cell(),
                                 is_all ? or_missing(row.memory_mb) : Cell(),
                                 is_all && row.is_on_front ? "1" : "", spread_of(to_first),
                                 or_missing(to_first.p_value), to_first.no_interval});
      for (const DifferingSetting& setting : board.differing) {
        cells.push_back(setting_cell(setting.values[r]));
      }
    };
    add("all", row.all, row.standing);
    for (std::size_t s = 0; s < board.sequences.size(); ++s) {
      add(board.sequences[s], row.sequences[s], row.sequence_standing[s]);
    }
  }
  return sheet;
}

ordered_json to_json(const Leaderboard& board, std::size_t r) {
  const LeaderboardRow& row = board.rows[r];
  ordered_json json = provenance_json(*row.run);
  json["differing_settings"] = ordered_json::object();
  for (const DifferingSetting& setting : board.differing) {
    const std::optional<SettingValue>& value = setting.values[r];
    json["differing_settings"][setting.name] =
        value ? mosbench::to_json(*value) : ordered_json(nullptr);
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
  json["standing"] = sentences(row.standing);
  json["to_first"] = row.to_first ? to_json(*row.to_first) : ordered_json(nullptr);
  return json;
}

}  // namespace

Answer leaderboard_answer(const Leaderboard& board) {
  Standing standing = board.rows.front().standing;
  standing.doubts = board.doubts;
  return {.standing = std::move(standing),
          .sheets = {sheet_of(board)},
          .records = records_of(board),
          .json = json_text(to_json(board))};
}

ordered_json to_json(const Leaderboard& board) {
  const Result& first = board.rows.front().run->front();
  ordered_json json = {{"dataset", first.dataset}};
  json.update(rule_json({first.protocol, first.range}));
  json.update(ordered_json{{"simulated", first.is_simulated()},
                           {"confidence", kConfidence},
                           {"sequences", board.sequences},
                           {"differing_settings", ordered_json::array()},
                           {"rows", ordered_json::array()},
                           {"remarks", board.doubts}});
  for (const DifferingSetting& setting : board.differing) {
    json["differing_settings"].push_back(setting.name);
  }
  for (std::size_t r = 0; r < board.rows.size(); ++r) json["rows"].push_back(to_json(board, r));
  for (const std::string& remark : board.remarks) json["remarks"].push_back(remark);
  return json;
}

}  // namespace mosbench
