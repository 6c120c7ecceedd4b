#pragma once

#include <mosbench/method.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/job/method_choice.hpp"
#include "eval/result/result.hpp"
#include "eval/statistics/intervals.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// How a measured value compares with the published one.
enum class Verdict {
  kPublishedOnly,  ///< nothing was measured
  kMeasuredOnly,   ///< nothing was published
  kWithin,         ///< the published value lies in the interval, up to its rounding
  kOutside,
  kNotComparable  ///< they differ in what `reasons` lists
};
std::string_view to_string(Verdict verdict);

struct TableCell {
  std::string column;
  std::optional<PublishedCell> published;
  std::optional<Estimate> measured;
  std::optional<double> difference;  ///< measured - published, fraction
  Verdict verdict = Verdict::kPublishedOnly;
  bool is_apart = false;   ///< measured by another protocol or over other scans than published
  bool simulated = false;  ///< what was measured is of simulated data
  std::vector<std::string> doubts;     ///< about what was measured
  std::vector<std::string> sequences;  ///< of the run, with the scene of simulated ones
  /// Why not comparable, why there is no average, or what to download and run.
  std::vector<std::string> reasons;
};

/// One method and setting; `results` is the folder of the measured results.
struct TableRow {
  std::string section, method, setting, protocol, source, results;
  std::vector<TableCell> cells;  ///< one per column of the table
  bool is_apart = false;         ///< without published values, because no cell compares with one
};

struct FilledTable {
  const PaperTable* table;
  std::vector<TableRow> rows;
  bool simulated() const;  ///< whether any cell is
};

/// Fills the published rows: each run goes to the row of its method that is nearest in variant,
/// voxel size, range, delay and protocol; runs of methods without a published row follow at the
/// end, among them always the method of preset `best`. A HeLiMOS run over all labelled scans
/// also gives the numbers of the test split. Values of another protocol, other scans or sequences
/// than the published ones have rows apart, which come last. A column of several sequences is empty
/// where one is missing.
FilledTable fill_table(const PaperTable& table, const std::vector<PublishedCell>& published,
                       const std::vector<ResultSet>& runs);

/// Returns a sentence for each result that belongs in no cell of the table.
std::vector<std::string> left_out(const PaperTable& table, const std::vector<ResultSet>& runs);

/// The published cells of one method, setting and section.
struct PublishedRow {
  std::vector<PublishedCell> cells;  ///< at least one
};

/// Returns the rows of a table in the order of publication.
std::vector<PublishedRow> published_rows(const PaperTable& table,
                                         const std::vector<PublishedCell>& published);

/// Returns the method of `mosbench run` that the row is of; null for other programs.
const MethodKind* own_method(const PublishedCell& cell);

/// Returns how the protocol differs from the published one; empty where it does not.
std::string other_protocol(const ResultSet& run, const PublishedCell& cell);

/// Lists how the run's method differs from the published one: variant, voxel size, range, delay,
/// setting in words.
std::vector<std::string> other_settings(const ResultSet& run, const PublishedCell& cell);

/// Returns the row of the run's method that differs in the fewest respects; the first of equal
/// ones.
std::optional<std::size_t> nearest_row(const ResultSet& run, const std::vector<PublishedRow>& rows);

/// Returns the runs of the table's data set and, for each HeLiMOS run over all labelled scans, the
/// same labels counted over the test split.
std::vector<ResultSet> with_splits(const PaperTable& table, const std::vector<ResultSet>& runs);

/// Returns what to download and the command whose results then fill `column` of the row that
/// `published` belongs to: for methods of mosbench `mosbench run` with the preset of the table's
/// data set that comes nearest to the published settings, for other methods `mosbench score`.
std::string how_to_fill(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published);

/// The same for a preset of a method that was published nowhere.
std::string how_to_fill(const PaperTable& table, const TableColumn& column, const Preset& preset);

}  // namespace mosbench
