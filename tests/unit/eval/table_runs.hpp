#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "eval/tables/table_cells.hpp"

// Results for the tests of published tables.

namespace mosbench {

inline const std::vector<PublishedCell>& published() {
  static const std::vector<PublishedCell> cells = built_in_cells();
  return cells;
}

/// `scans` labelled scans of 1000 moving points, of which `found` plus or minus a few are.
inline Result sequence(const std::string& name, std::size_t scans, std::uint64_t found,
                       std::size_t apart_scans = 1) {
  Result result;
  result.sequence = SequenceName(name, name);
  result.dataset = "doals";
  result.method = "HMM-MOS";
  result.setting = "as the paper";
  result.protocol = &protocol_named("doals-hmm");
  result.settings = recorded_settings({{"variant", "paper-2024"},
                                       {"voxel_size_m", 0.2},
                                       {"max_range_m", 20.0},
                                       {"delay_scans", 0}});
  for (std::size_t k = 0; k < scans; ++k) {
    Confusion counts;
    counts.tp = found + 20 * (k % 2) - 10;
    counts.fn = 1000 - counts.tp;
    ScanRow& row = result.scans.emplace_back();
    row.stem = std::to_string(k * apart_scans);
    row.counts = counts;
  }
  return result;
}

/// Labelled scans of DOALS are 100 to 200 scans apart.
inline ResultSet station(std::uint64_t found, std::size_t apart_scans = 200) {
  return {"runs/doals",
          {sequence("station/sequence_1", 10, found, apart_scans),
           sequence("station/sequence_2", 10, found, apart_scans)}};
}

/// The sequence of Sipailou's validation, of which enough scans are labelled for an interval.
inline ResultSet valid(std::uint64_t found) {
  Result result = sequence("06", 3191, found);
  result.dataset = "sipailou";
  result.protocol = &protocol_named("sipailou");
  result.settings->set("voxel_size_m", 0.25);
  result.settings->set("max_range_m", 50.0);
  return {"runs/sipailou", {result}};
}

inline TableCell cell_of(const FilledTable& table, std::size_t column = 0) {
  for (const TableRow& row : table.rows) {
    if (!row.results.empty()) return row.cells.at(column);
  }
  throw std::runtime_error("no measured row");
}

/// The rows of results, apart from published values or beside them.
inline std::vector<TableRow> rows_of_runs(const FilledTable& table, bool apart) {
  std::vector<TableRow> rows;
  for (const TableRow& row : table.rows) {
    if (!row.results.empty() && row.is_apart == apart) rows.push_back(row);
  }
  return rows;
}

inline FilledTable filled(const std::vector<ResultSet>& runs, const char* table = "I") {
  return fill_table(paper_table_named(table), published(), runs);
}

inline ResultSet helimos(const std::string& protocol, const std::vector<std::string>& sensors) {
  ResultSet run{"runs/helimos", {}};
  for (const std::string& name : sensors) {
    Result part = sequence(name, 40, 500);
    part.dataset = "helimos";
    part.protocol = &protocol_named(protocol);
    run.sequences.push_back(part);
  }
  return run;
}

}  // namespace mosbench
