#include "eval/tables/table_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// Lists what the run lacks of the column's scans.
std::vector<std::string> gaps(const ResultSet& part, const TableColumn& column) {
  std::vector<std::string> gaps;
  for (const std::string_view name : column.sequences) {
    const bool there = std::ranges::any_of(part.sequences, [&](const Result& result) {
      return contains({.name = "", .sequences = {name}, .scans = {}}, result.sequence);
    });
    if (!there) gaps.push_back(fmt::format("sequence {} is missing", name));
  }
  std::size_t scans = 0;
  for (const Result& sequence : part.sequences) scans += counted_scans(sequence).size();
  for (std::string& shortfall : shortfalls(part)) gaps.push_back(std::move(shortfall));
  const bool known =
      column.scans && !part.sequences.empty() &&
      (column.scans_protocol.empty() || column.scans_protocol == part.front().protocol->name);
  if (known && scans != *column.scans) {
    gaps.push_back(fmt::format("{} labelled scans, published over {}", scans, *column.scans));
  }
  return gaps;
}

/// Half a unit of the last printed digit, as a fraction.
double rounding(const PublishedCell& cell) {
  const std::size_t point = cell.iou_percent.find('.');
  const std::size_t digits = point == std::string::npos ? 0 : cell.iou_percent.size() - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(digits)) / 100.0;
}

Verdict judge(const TableCell& cell) {
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

TableCell measured_cell(const PaperTable& table, const TableColumn& column, const ResultSet& run,
                        const PublishedRow* row) {
  TableCell cell;
  cell.column = column.name;
  if (row != nullptr) cell.published = find_cell(*row, column.name);
  const ResultSet part = in_column(run, column);
  if (part.sequences.empty()) {
    if (cell.published) cell.reasons = {how_to_fill(table, column, *cell.published)};
    return cell;
  }
  for (const Result& sequence : part.sequences) {
    cell.sequences.push_back(sequence.sequence);
    const std::optional<SimulatedOrigin>& origin = sequence.from.simulated;
    if (!origin) continue;
    cell.sequences.back() +=
        fmt::format(" (simulated, scene {}, seed {})", origin->scene, origin->seed);
  }
  cell.measured = estimate(part.sequences)[Metric::kIou];
  if (row != nullptr) cell.reasons = mismatches(run, cell.published.value_or(row->cells.front()));
  for (const Result& sequence : part.sequences) {
    const std::string perturb = disturbance_of(sequence);
    if (perturb.empty()) continue;
    cell.reasons.push_back(
        fmt::format("sequence {} is disturbed by {}", sequence.sequence.text(), perturb));
  }
  cell.simulated = run.front().is_simulated();
  if (cell.simulated) cell.reasons.insert(cell.reasons.begin(), "simulated data");
  for (const std::string& doubt : warnings(part)) cell.doubts.push_back(doubt);
  for (std::string& gap : gaps(part, column)) cell.reasons.push_back(std::move(gap));
  if (!cell.measured->value) {
    cell.reasons.push_back("IoU is undefined");
  } else if (cell.published) {
    cell.difference = *cell.measured->value - cell.published->iou();
  }
  cell.verdict = judge(cell);
  if (cell.verdict == Verdict::kNotComparable && cell.reasons.empty())
    cell.reasons.push_back("no interval: " + cell.measured->no_interval);
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

TableRow measured_row(const PaperTable& table, const ResultSet& run, const PublishedRow* row) {
  const Result& first = run.front();
  TableRow filled{.section = "",
                  .method = first.method,
                  .setting = first.setting,
                  .protocol = std::string(first.protocol->name),
                  .source = row == nullptr ? "" : row->cells.front().source,
                  .results = run.path.string(),
                  .cells = {}};
  const bool same_rules = row != nullptr && row->cells.front().protocol == filled.protocol;
  if (same_rules) filled.section = row->cells.front().section;
  for (const TableColumn& column : table.columns) {
    filled.cells.push_back(measured_cell(table, column, run, row));
  }
  return filled;
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
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (of_row[r].empty()) filled.rows.push_back(published_row(table, rows[r]));
    for (const ResultSet& run : of_row[r])
      filled.rows.push_back(measured_row(table, run, &rows[r]));
  }
  const Preset& best = preset_named("best");
  const MethodKind& method = *find_method(best.method);
  const bool is_measured = std::ranges::any_of(
      unmatched, [&](const ResultSet& run) { return run.front().method == method.title; });
  if (!is_measured) filled.rows.push_back(best_row(table, best, method));
  for (const ResultSet& run : unmatched) filled.rows.push_back(measured_row(table, run, nullptr));
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
