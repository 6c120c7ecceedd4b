#include "eval/tables/table_print.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/csv.hpp"
#include "eval/answer/latex.hpp"
#include "eval/answer/markdown.hpp"
#include "eval/answer/text_table.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

bool is_measured(const TableCell& cell) {
  return cell.verdict != Verdict::kPublishedOnly && cell.measured;
}

/// Formats a cell without its reasons.
std::string cell_text(const TableCell& cell) {
  const std::string published = cell.published ? cell.published->iou_percent : "";
  if (!is_measured(cell)) return published.empty() ? "-" : published;
  std::string text = published.empty() ? "" : published + " / ";
  text += percent_text(cell.measured->value, "{:.1f}");
  if (cell.difference) text += fmt::format(" ({:+.1f})", *cell.difference * 100.0);
  if (cell.measured->interval) {
    text += fmt::format(" [{}, {}]", percent_text(cell.measured->interval->low, "{:.1f}"),
                        percent_text(cell.measured->interval->high, "{:.1f}"));
  } else if (!cell.measured->no_interval.empty()) {
    text += " [no interval]";
  }
  return fmt::format("{} {}", text, to_string(cell.verdict));
}

std::string joined(const std::vector<std::string>& texts, const char* between) {
  return fmt::format("{}", fmt::join(texts, between));
}

/// Numbered footnotes without duplicates.
class Notes {
 public:
  std::string mark(const std::vector<std::string>& reasons) {
    if (reasons.empty()) return "";
    const std::string text = joined(reasons, "; ");
    const auto known = std::ranges::find(texts_, text);
    const auto number = known - texts_.begin() + 1;
    if (known == texts_.end()) texts_.push_back(text);
    return fmt::format(" ({})", number);
  }
  std::string str() const {
    std::string text;
    for (std::size_t i = 0; i < texts_.size(); ++i) {
      text += fmt::format("- ({}) {}\n", i + 1, markdown_text(texts_[i]));
    }
    return text;
  }

 private:
  std::vector<std::string> texts_;
};

std::string row_setting(const TableRow& row) {
  return row.section.empty() ? row.setting
                             : row.section + (row.setting.empty() ? "" : ", " + row.setting);
}

std::vector<std::string> column_titles(const FilledTable& table) {
  std::vector<std::string> titles = {"method", "setting", "protocol"};
  for (const TableColumn& column : table.table->columns) titles.emplace_back(column.name);
  return titles;
}

std::vector<std::string> row_titles(const TableRow& row) {
  return {row.method, row_setting(row), row.protocol};
}

/// "results/runs/doals: ST is station/sequence_1, ...; SV is ...", one line per run.
std::vector<std::string> measured_sequences(const FilledTable& table) {
  std::vector<std::string> lines;
  for (const TableRow& row : table.rows) {
    std::vector<std::string> columns;
    for (const TableCell& cell : row.cells) {
      if (!cell.sequences.empty())
        columns.push_back(cell.column + " is " + joined(cell.sequences, ", "));
    }
    const std::string line = row.results + ": " + joined(columns, "; ");
    if (!columns.empty() && std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

bool is_simulated(const FilledTable& table) {
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) {
      if (std::ranges::find(cell.reasons, "simulated data") != cell.reasons.end()) return true;
    }
  }
  return false;
}

/// Names the command that does what the footnotes say one by one, where there is one.
std::string hint_on_runs(const FilledTable& table) {
  using enum DatasetKind;
  const DatasetKind kind = table.table->dataset;
  const bool is_reproduced = kind == kDoals || kind == kSipailou || kind == kHelimos;
  const bool lacks_runs = std::ranges::any_of(table.rows, [](const TableRow& row) {
    return std::ranges::any_of(
        row.cells, [](const TableCell& cell) { return !cell.measured && !cell.reasons.empty(); });
  });
  if (!is_reproduced || !lacks_runs) return "";
  return fmt::format("\n`mosbench reproduce {} --data DIR` does most of that at once.\n",
                     to_string(kind));
}

std::string interval_end(const Estimate& estimate, double Interval::*end) {
  return estimate.interval ? csv_percent((*estimate.interval).*end) : "";
}

ordered_json to_json(const TableCell& cell) {
  ordered_json json = {{"column", cell.column},
                       {"verdict", std::string(to_string(cell.verdict))},
                       {"reasons", cell.reasons},
                       {"sequences", cell.sequences}};
  json["published"] = cell.published ? ordered_json(cell.published->iou()) : ordered_json(nullptr);
  json["published_percent"] = cell.published ? cell.published->iou_percent : "";
  json["note"] = cell.published ? cell.published->note : "";
  const Estimate measured = cell.measured.value_or(Estimate{});
  json["measured"] = json_or_null(measured.value);
  json["difference"] = json_or_null(cell.difference);
  json["low"] = measured.interval ? ordered_json(measured.interval->low) : ordered_json(nullptr);
  json["high"] = measured.interval ? ordered_json(measured.interval->high) : ordered_json(nullptr);
  json["no_interval"] =
      measured.no_interval.empty() ? ordered_json(nullptr) : ordered_json(measured.no_interval);
  return json;
}

}  // namespace

std::string table_markdown(const FilledTable& table) {
  std::string text = fmt::format("## Table {}: {}\n\nAverage: {}.\n", table.table->name,
                                 table.table->title, table.table->averaging);
  if (is_simulated(table)) {
    text += "Measured on SIMULATED data: not comparable with the published numbers.\n";
  }
  const std::vector<std::string> titles = column_titles(table);
  text += '\n' + markdown_row(titles) + '|';
  for (std::size_t i = 0; i < titles.size(); ++i) text += "---|";
  text += '\n';
  Notes notes;
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells = row_titles(row);
    for (const TableCell& cell : row.cells) {
      cells.push_back(cell_text(cell) + notes.mark(cell.reasons));
    }
    text += markdown_row(cells);
  }
  text += "\nCells: published, or published / measured (difference) [95 % interval] verdict.\n\n";
  for (const std::string& line : measured_sequences(table)) {
    text += "- " + markdown_text(line) + '\n';
  }
  return text + notes.str() + hint_on_runs(table);
}

std::string table_latex(const FilledTable& table) {
  std::string text = fmt::format("% {}\n", table.table->title);
  if (is_simulated(table)) text += "% measured on SIMULATED data: not comparable\n";
  for (const std::string& line : measured_sequences(table)) {
    text += "% " + latex_text(line) + '\n';
  }
  text +=
      fmt::format("\\begin{{tabular}}{{lll{}}}\n", std::string(table.table->columns.size(), 'r'));
  text += latex_row(column_titles(table)) + "\\hline\n";
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells = row_titles(row);
    for (const TableCell& cell : row.cells) cells.push_back(cell_text(cell));
    text += latex_row(cells);
  }
  return text + "\\end{tabular}\n";
}

std::string table_csv(const FilledTable& table) {
  std::string text =
      "table,section,method,setting,protocol,column,published_percent,measured_percent,"
      "difference_points,low_percent,high_percent,verdict,reasons,source,results,"
      "sequences\n";
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) {
      const Estimate measured = cell.measured.value_or(Estimate{});
      const std::vector<std::string> cells = {std::string(table.table->name),
                                              row.section,
                                              row.method,
                                              row.setting,
                                              row.protocol,
                                              cell.column,
                                              cell.published ? cell.published->iou_percent : "",
                                              csv_percent(measured.value),
                                              csv_percent(cell.difference),
                                              interval_end(measured, &Interval::low),
                                              interval_end(measured, &Interval::high),
                                              std::string(to_string(cell.verdict)),
                                              joined(cell.reasons, "; "),
                                              row.source,
                                              row.results,
                                              joined(cell.sequences, "; ")};
      text += csv_row(cells);
    }
  }
  return text;
}

ordered_json to_json(const FilledTable& table) {
  ordered_json json = {{"table", std::string(table.table->name)},
                       {"title", std::string(table.table->title)},
                       {"averaging", std::string(table.table->averaging)},
                       {"download", std::string(table.table->download)},
                       {"simulated", is_simulated(table)},
                       {"columns", ordered_json::array()},
                       {"rows", ordered_json::array()}};
  for (const TableColumn& column : table.table->columns) {
    json["columns"].push_back(std::string(column.name));
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
                            {"cells", cells}});
  }
  return json;
}

}  // namespace mosbench
