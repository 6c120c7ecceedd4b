#include "eval/tables/table_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "eval/statistics/run_statistics.hpp"
#include "eval/tables/leaderboard.hpp"

namespace mosbench {
namespace {

ResultSet in_column(const ResultSet& run, const TableColumn& column) {
  ResultSet part{run.path, {}};
  for (const Result& sequence : run.sequences) {
    if (contains(column, sequence.sequence)) part.sequences.push_back(sequence);
  }
  return part;
}

/// Returns the sequences of the column that a run lacks.
std::vector<std::string_view> missing_members(const ResultSet& part, const TableColumn& column) {
  std::vector<std::string_view> missing = column.sequences;
  std::erase_if(missing, [&](std::string_view name) {
    return std::ranges::any_of(part.sequences, [&](const Result& result) {
      return contains({.name = "", .sequences = {name}, .scans = {}}, result.sequence);
    });
  });
  return missing;
}

/// Says how many scans of a column were counted where published values are over another number.
std::string other_count(const ResultSet& part, const TableColumn& column) {
  std::size_t scans = 0;
  for (const Result& sequence : part.sequences) scans += counted_scans(sequence).size();
  const bool known = column.scans && (column.scans_protocol.empty() ||
                                      column.scans_protocol == part.front().protocol->name);
  if (!known || scans == *column.scans) return "";
  return fmt::format("{} labelled scans, published over {}", scans, *column.scans);
}

/// Lists how a run's scans of a column, or of one within it, differ from the published ones.
std::vector<std::string> other_scans(const ResultSet& part, const PaperTable& table,
                                     const TableColumn& column) {
  std::vector<std::string> reasons;
  for (const Result& sequence : part.sequences) {
    const std::string perturb = disturbance_of(sequence);
    if (perturb.empty()) continue;
    reasons.push_back(
        fmt::format("sequence {} is disturbed by {}", sequence.sequence.text(), perturb));
  }
  // An average that lacks a sequence is empty: which of its scans are there says nothing more.
  if (!missing_members(part, column).empty()) return reasons;
  for (std::string& shortfall : shortfalls(part.sequences)) reasons.push_back(std::move(shortfall));
  for (const TableColumn& inner : table.columns) {
    const bool is_within = std::ranges::all_of(inner.sequences, [&](std::string_view name) {
      return contains(column, std::string(name));
    });
    if (!is_within) continue;
    std::string count = other_count(in_column(part, inner), inner);
    if (&inner != &column && !count.empty()) count = fmt::format("{}: {}", inner.name, count);
    if (!count.empty()) reasons.push_back(std::move(count));
  }
  return reasons;
}

/// Half a unit of the last printed digit, as a fraction.
double rounding(const PublishedCell& cell) {
  const std::size_t point = cell.iou_percent.find('.');
  const std::size_t digits = point == std::string::npos ? 0 : cell.iou_percent.size() - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(digits)) / 100.0;
}

Verdict judge(const TableCell& cell) {
  if (cell.is_apart) return Verdict::kNotComparable;
  if (!cell.published) return Verdict::kMeasuredOnly;
  if (!cell.reasons.empty()) return Verdict::kNotComparable;
  const double published = cell.published->iou();
  const double slack = rounding(*cell.published) + 1e-12;
  const double value = *cell.measured->value;
  const Interval interval = cell.measured->interval.value_or(Interval{value, value});
  const bool within = interval.low - slack <= published && published <= interval.high + slack;
  if (within) return Verdict::kWithin;
  return cell.measured->interval ? Verdict::kOutside : Verdict::kNotComparable;
}

/// Finds the published cell of a column.
std::optional<PublishedCell> find_cell(const PublishedRow& row, std::string_view column) {
  const auto found = std::ranges::find(row.cells, column, &PublishedCell::column);
  if (found == row.cells.end()) return std::nullopt;
  return *found;
}

/// A run among the published rows of its table; `row` is the one of its method.
struct Placed {
  const PaperTable& table;
  const std::vector<PublishedRow>& rows;
  const ResultSet& run;
  const PublishedRow* row;
};

/// Returns how the protocol differs from that of the published cell or, where the method was not
/// published, from those of all rows.
std::string other_protocol(const Placed& placed, const std::optional<PublishedCell>& published) {
  if (placed.row != nullptr) {
    return other_protocol(placed.run, published.value_or(placed.row->cells.front()));
  }
  const bool is_published = std::ranges::any_of(placed.rows, [&](const PublishedRow& row) {
    return other_protocol(placed.run, row.cells.front()).empty();
  });
  return is_published ? ""
                      : fmt::format("protocol {}, by which nothing was published",
                                    placed.run.front().protocol->name);
}

/// The published value, and how to measure one beside it.
TableCell unmeasured_cell(const Placed& placed, const TableColumn& column) {
  TableCell cell;
  cell.column = column.name;
  if (placed.row != nullptr) cell.published = find_cell(*placed.row, column.name);
  if (cell.published) cell.reasons = {how_to_fill(placed.table, column, *cell.published)};
  return cell;
}

/// Lists why a value stands apart from the published ones.
std::vector<std::string> reasons_apart(const Placed& placed, const TableColumn& column,
                                       const ResultSet& part, const TableCell& cell) {
  std::vector<std::string> reasons;
  if (cell.simulated) reasons.emplace_back("simulated data");
  std::string protocol = other_protocol(placed, cell.published);
  if (!protocol.empty()) reasons.push_back(std::move(protocol));
  for (std::string& reason : other_scans(part, placed.table, column))
    reasons.push_back(std::move(reason));
  return reasons;
}

std::vector<std::string> named_sequences(const ResultSet& part) {
  std::vector<std::string> names;
  for (const Result& sequence : part.sequences) {
    names.push_back(sequence.sequence);
    const std::optional<SimulatedOrigin>& origin = sequence.from.simulated;
    if (!origin) continue;
    names.back() += fmt::format(" (simulated, scene {}, seed {})", origin->scene, origin->seed);
  }
  return names;
}

/// Measures a cell whose sequences are all there.
void measure(const Placed& placed, const ResultSet& part, TableCell& cell) {
  cell.measured = estimate(part.sequences)[Metric::kIou];
  if (placed.row != nullptr) {
    const PublishedCell& nearest = cell.published.value_or(placed.row->cells.front());
    for (std::string& reason : other_settings(placed.run, nearest)) {
      cell.reasons.push_back(std::move(reason));
    }
  }
  if (!cell.measured->value) {
    cell.reasons.push_back("IoU is undefined");
  } else if (cell.published && !cell.is_apart) {
    cell.difference = *cell.measured->value - cell.published->iou();
  }
  cell.verdict = judge(cell);
  if (cell.verdict == Verdict::kNotComparable && cell.reasons.empty())
    cell.reasons.push_back("no interval: " + cell.measured->no_interval);
}

TableCell measured_cell(const Placed& placed, const TableColumn& column) {
  TableCell cell = unmeasured_cell(placed, column);
  const ResultSet part = in_column(placed.run, column);
  if (part.sequences.empty()) return cell;
  cell.sequences = named_sequences(part);
  cell.simulated = part.front().is_simulated();
  cell.doubts = warnings(part);
  cell.reasons = reasons_apart(placed, column, part, cell);
  cell.is_apart = !cell.reasons.empty();
  const std::vector<std::string_view> missing = missing_members(part, column);
  if (missing.empty()) {
    measure(placed, part, cell);
  } else {
    cell.reasons.push_back(fmt::format("no value over {}: sequence {} is missing",
                                       fmt::join(column.sequences, ", "),
                                       fmt::join(missing, ", ")));
    if (cell.published && !cell.is_apart) {
      cell.reasons.push_back(how_to_fill(placed.table, column, *cell.published));
    }
  }
  return cell;
}

/// The empty row of a published setting.
TableRow published_row(const PaperTable& table, const PublishedRow& row) {
  const PublishedCell& first = row.cells.front();
  TableRow filled{first.section, first.method, first.setting, first.protocol, first.source, "", {}};
  for (const TableColumn& column : table.columns) {
    TableCell& cell = filled.cells.emplace_back();
    cell.column = column.name;
    cell.published = find_cell(row, column.name);
    if (own_method(first) == nullptr) continue;
    cell.reasons = {how_to_fill(table, column, cell.published.value_or(first))};
  }
  return filled;
}

/// Returns the empty row of the method that is better than the paper's and published nowhere.
TableRow best_row(const PaperTable& table, const Preset& best, const MethodKind& method) {
  const std::string_view protocol = preset_for(best, table.dataset).protocol;
  TableRow row{"",
               std::string(method.title),
               fmt::format("preset {}", best.name),
               std::string(protocol),
               std::string(method.source),
               "",
               {}};
  for (const TableColumn& column : table.columns) {
    TableCell& cell = row.cells.emplace_back();
    cell.column = column.name;
    cell.reasons = {how_to_fill(table, column, best)};
  }
  return row;
}

/// Returns the section of the published row; where the method was not published, that of all rows
/// by the protocol, if they share one.
std::string section_of(const Placed& placed) {
  std::optional<std::string> section;
  for (const PublishedRow& row : placed.rows) {
    const PublishedCell& first = row.cells.front();
    if (placed.row != nullptr && placed.row != &row) continue;
    if (!other_protocol(placed.run, first).empty()) continue;
    if (section && *section != first.section) return "";
    section = first.section;
  }
  return section.value_or("");
}

/// The rows of a run: beside published values, and apart from them.
struct MeasuredRows {
  std::optional<TableRow> beside, apart;
};

MeasuredRows measured_rows(const Placed& placed) {
  const Result& first = placed.run.front();
  TableRow beside{.section = section_of(placed),
                  .method = first.method,
                  .setting = first.setting,
                  .protocol = std::string(first.protocol->name),
                  .source = placed.row == nullptr ? "" : placed.row->cells.front().source,
                  .results = placed.run.path.string(),
                  .cells = {}};
  TableRow apart = beside;
  apart.is_apart = true;
  MeasuredRows rows;
  bool has_apart = false, has_beside = false;
  for (const TableColumn& column : placed.table.columns) {
    TableCell cell = measured_cell(placed, column);
    TableCell& other = apart.cells.emplace_back();
    other.column = cell.column;
    has_apart = has_apart || cell.is_apart;
    has_beside = has_beside || (!cell.is_apart && !cell.sequences.empty());
    if (cell.is_apart) {
      cell.published.reset();
      other = std::exchange(cell, unmeasured_cell(placed, column));
    }
    beside.cells.push_back(std::move(cell));
  }
  if (has_beside) rows.beside = std::move(beside);
  if (has_apart) rows.apart = std::move(apart);
  return rows;
}

bool has_values(const PaperTable& table, const ResultSet& run) {
  return std::ranges::any_of(
      run.sequences, [&](const Result& sequence) { return contains(table, sequence.sequence); });
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  static constexpr std::array<std::string_view, 5> kTexts = {"not measured", "not published",
                                                             "within", "outside", "not comparable"};
  return kTexts[static_cast<std::size_t>(verdict)];
}

bool FilledTable::simulated() const {
  return std::ranges::any_of(rows, [](const TableRow& row) {
    return std::ranges::any_of(row.cells, &TableCell::simulated);
  });
}

FilledTable fill_table(const PaperTable& table, const std::vector<PublishedCell>& published,
                       const std::vector<ResultSet>& runs) {
  FilledTable filled{&table, {}};
  const std::vector<PublishedRow> rows = published_rows(table, published);
  std::vector<std::vector<ResultSet>> of_row(rows.size());
  std::vector<ResultSet> unmatched;
  for (ResultSet& run : with_splits(table, runs)) {
    if (!has_values(table, run)) continue;
    const auto nearest = nearest_row(run, rows);
    (nearest ? of_row[*nearest] : unmatched).push_back(std::move(run));
  }
  std::vector<TableRow> apart;
  /// Returns whether the run has a row beside published values.
  const auto add = [&](const ResultSet& run, const PublishedRow* row) {
    MeasuredRows measured = measured_rows({table, rows, run, row});
    if (measured.apart) apart.push_back(std::move(*measured.apart));
    if (measured.beside) filled.rows.push_back(std::move(*measured.beside));
    return measured.beside.has_value();
  };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    bool has_run = false;
    for (const ResultSet& run : of_row[r]) has_run = add(run, &rows[r]) || has_run;
    if (!has_run) filled.rows.push_back(published_row(table, rows[r]));
  }
  const Preset& best = preset_named("best");
  const MethodKind& method = *find_method(best.method);
  const bool is_measured = std::ranges::any_of(
      unmatched, [&](const ResultSet& run) { return run.front().method == method.title; });
  if (!is_measured) filled.rows.push_back(best_row(table, best, method));
  for (const ResultSet& run : unmatched) add(run, nullptr);
  std::ranges::move(apart, std::back_inserter(filled.rows));
  return filled;
}

std::vector<std::string> left_out(const PaperTable& table, const std::vector<ResultSet>& runs) {
  std::vector<std::string> sentences;
  for (const ResultSet& run : runs) {
    for (const Result& sequence : run.sequences) {
      std::string why;
      if (sequence.dataset != to_string(table.dataset)) {
        why = fmt::format("is of data set {}, not {}", sequence.dataset, to_string(table.dataset));
      } else if (!contains(table, sequence.sequence)) {
        why = fmt::format("is of sequence {}, which is in no column", sequence.sequence.text());
      }
      if (why.empty()) continue;
      sentences.push_back(
          fmt::format("left out of table {}: {} {}", table.name, sequence.file.string(), why));
    }
  }
  return sentences;
}

}  // namespace mosbench
