#include "eval/tables/table_print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Formats a cell without its reasons.
std::string cell_text(const TableCell& cell) {
  const std::string published = cell.published ? cell.published->iou_percent : "";
  if (!cell.measured) return published.empty() ? "-" : published;
  std::string text = published.empty() ? "" : published + " / ";
  text += percent_text(cell.measured->value);
  if (cell.difference) text += fmt::format(" ({:+.1f})", *cell.difference * 100.0);
  if (cell.measured->interval) {
    text += fmt::format(" [{}, {}]", percent_text(cell.measured->interval->low),
                        percent_text(cell.measured->interval->high));
  } else if (!cell.measured->no_interval.empty()) {
    text += " [no interval]";
  }
  return fmt::format("{} {}", text, to_string(cell.verdict));
}

std::string joined(const std::vector<std::string>& texts, const char* between) {
  return fmt::format("{}", fmt::join(texts, between));
}

/// Returns " (2)" of the second footnote, which is added if no other says the same.
std::string mark_of(const std::vector<std::string>& reasons, std::vector<std::string>& footnotes) {
  if (reasons.empty()) return "";
  const std::string text = joined(reasons, "; ");
  const auto number = std::ranges::find(footnotes, text) - footnotes.begin() + 1;
  if (std::cmp_greater(number, footnotes.size())) footnotes.push_back(text);
  return fmt::format(" ({})", number);
}

/// The rows that stand in one block: of a published section, or apart from all of them.
struct Block {
  std::string title;
  std::vector<const TableRow*> rows;
};

std::vector<Block> blocks_of(const FilledTable& table) {
  std::vector<Block> blocks;
  for (const TableRow& row : table.rows) {
    const std::string title = row.is_apart ? "not comparable with published values" : row.section;
    auto block = std::ranges::find(blocks, title, &Block::title);
    if (block == blocks.end()) block = blocks.insert(block, Block{title, {}});
    block->rows.push_back(&row);
  }
  return blocks;
}

/// "results/runs/doals: ST is station/sequence_1, ...; SV is ...", one line per run.
std::vector<std::string> measured_sequences(const Block& block) {
  std::vector<std::string> lines;
  for (const TableRow* row : block.rows) {
    std::vector<std::string> columns;
    for (const TableCell& cell : row->cells) {
      if (cell.measured) columns.push_back(cell.column + " is " + joined(cell.sequences, ", "));
    }
    const std::string line = row->results + ": " + joined(columns, "; ");
    if (!columns.empty() && std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

/// Names the command that does what the footnotes say one by one, where there is one.
std::string hint_on_runs(const FilledTable& table) {
  const DatasetKind kind = table.table->dataset;
  const bool is_reproduced = kind == DatasetKind::kDoals || kind == DatasetKind::kSipailou ||
                             kind == DatasetKind::kHelimos;
  const bool lacks_runs = std::ranges::any_of(table.rows, [](const TableRow& row) {
    return std::ranges::any_of(
        row.cells, [](const TableCell& cell) { return !cell.measured && !cell.reasons.empty(); });
  });
  if (!is_reproduced || !lacks_runs) return "";
  return fmt::format("`mosbench run table:{} --data DIR` does most of that at once",
                     table.table->name);
}

Spread measured_spread(const TableCell& cell) {
  return spread_of(cell.measured.value_or(Estimate{}));
}

Sheet sheet_of(const Block& block, const PaperTable& table) {
  Sheet sheet{
      .title = fmt::format("Table {}: {}{}{}", table.name, table.title,
                           block.title.empty() ? "" : ", ", block.title),
      .columns = {{"method", Unit::kText}, {"setting", Unit::kText}, {"protocol", Unit::kText}}};
  for (const TableColumn& column : table.columns) {
    sheet.columns.push_back({std::string(column.name)});
  }
  std::vector<std::string> footnotes;
  for (const TableRow* row : block.rows) {
    sheet.rows.push_back({row->method, row->setting, row->protocol});
    Standing& standing = sheet.row_standing.emplace_back();
    for (const TableCell& cell : row->cells) {
      standing.doubts.insert(standing.doubts.end(), cell.doubts.begin(), cell.doubts.end());
      sheet.rows.back().push_back(cell_text(cell) + mark_of(cell.reasons, footnotes));
    }
  }
  for (std::string& line : measured_sequences(block)) sheet.notes.push_back(std::move(line));
  const char* why = block.rows.front()->is_apart ? "not comparable: " : "";
  for (std::size_t i = 0; i < footnotes.size(); ++i) {
    sheet.notes.push_back(fmt::format("({}) {}{}", i + 1, why, footnotes[i]));
  }
  return sheet;
}

/// "Average: points pooled per sensor. ST: station/sequence_1, station/sequence_2."
std::string averages_line(const PaperTable& table) {
  std::string line = fmt::format("Average: {}.", table.averaging);
  for (const TableColumn& column : table.columns) {
    if (column.sequences.size() == 1) continue;
    line += fmt::format(" {}: {}.", column.name, fmt::join(column.sequences, ", "));
  }
  return line;
}

std::vector<Sheet> sheets_of(const FilledTable& table) {
  std::vector<Sheet> sheets;
  for (const Block& block : blocks_of(table)) sheets.push_back(sheet_of(block, *table.table));
  sheets.front().lead = {averages_line(*table.table),
                         "Cells: published, or published / measured (difference) [95 % interval] "
                         "verdict."};
  if (std::string hint = hint_on_runs(table); !hint.empty()) {
    sheets.back().notes.push_back(std::move(hint));
  }
  return sheets;
}

/// A row per cell with all of its members.
Sheet records_of(const FilledTable& table) {
  Sheet sheet;
  for (const char* name :
       {"table", "section", "method", "setting", "protocol", "column", "published_percent"}) {
    sheet.columns.push_back({name});
  }
  sheet.columns.push_back({"measured", Unit::kPercent});
  sheet.columns.push_back({"difference", Unit::kPoints});
  sheet.columns.push_back({"low", Unit::kPercent});
  sheet.columns.push_back({"high", Unit::kPercent});
  for (const char* name : {"verdict", "reasons", "source", "results", "sequences", "over"}) {
    sheet.columns.push_back({name});
  }
  for (const TableRow& row : table.rows) {
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      const TableCell& cell = row.cells[c];
      const Spread measured = measured_spread(cell);
      sheet.row_standing.push_back({cell.simulated, "", cell.doubts});
      sheet.rows.push_back(
          {std::string(table.table->name), row.section, row.method, row.setting, row.protocol,
           cell.column, cell.published ? cell.published->iou_percent : "",
           or_missing(measured.value), or_missing(cell.difference), or_missing(measured.low),
           or_missing(measured.high), std::string(to_string(cell.verdict)),
           joined(cell.reasons, "; "), row.source, row.results, joined(cell.sequences, "; "),
           fmt::format("{}", fmt::join(table.table->columns[c].sequences, "; "))});
    }
  }
  return sheet;
}

ordered_json to_json(const TableCell& cell) {
  ordered_json json = {{"column", cell.column},
                       {"verdict", std::string(to_string(cell.verdict))},
                       {"reasons", cell.reasons},
                       {"sequences", cell.sequences}};
  json["published"] = cell.published ? ordered_json(cell.published->iou()) : ordered_json(nullptr);
  json["published_percent"] = cell.published ? cell.published->iou_percent : "";
  json["note"] = cell.published ? cell.published->note : "";
  const Spread measured = measured_spread(cell);
  json["measured"] = json_or_null(measured.value);
  json["difference"] = json_or_null(cell.difference);
  json.update(interval_json(measured));
  return json;
}

Standing standing_of(const FilledTable& table) {
  std::vector<Doubt> doubts;
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) {
      for (const std::string& doubt : cell.doubts) doubts.push_back({row.method, doubt});
    }
  }
  return {table.simulated(), "", told(doubts)};
}

}  // namespace

Answer table_answer(const FilledTable& table) {
  return {.usual = Format::kMarkdown,
          .standing = standing_of(table),
          .sheets = sheets_of(table),
          .records = records_of(table),
          .json = json_text(to_json(table))};
}

ordered_json to_json(const FilledTable& table) {
  ordered_json json = {{"table", std::string(table.table->name)},
                       {"title", std::string(table.table->title)},
                       {"averaging", std::string(table.table->averaging)},
                       {"download", std::string(table.table->download)},
                       {"simulated", table.simulated()},
                       {"columns", ordered_json::array()},
                       {"column_sequences", ordered_json::array()},
                       {"rows", ordered_json::array()}};
  for (const TableColumn& column : table.table->columns) {
    json["columns"].push_back(std::string(column.name));
    json["column_sequences"].push_back(column.sequences);
  }
  for (const TableRow& row : table.rows) {
    ordered_json cells = ordered_json::array();
    for (const TableCell& cell : row.cells) cells.push_back(to_json(cell));
    json["rows"].push_back({{"section", row.section},
                            {"method", row.method},
                            {"setting", row.setting},
                            {"protocol", row.protocol},
                            {"source", row.source},
                            {"results", row.results},
                            {"apart", row.is_apart},
                            {"cells", cells}});
  }
  return json;
}

}  // namespace mosbench
