#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/result/result_set.hpp"
#include "eval/statistics/intervals.hpp"
#include "eval/tables/paper_tables.hpp"
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
  bool simulated = false;              ///< what was measured is of simulated data
  std::vector<std::string> sequences;  ///< measured ones, with the scene of simulated ones
  std::vector<std::string> reasons;    ///< why not comparable, or what to download and run
};

/// One method and setting; `results` is the folder of the measured results.
struct TableRow {
  std::string section, method, setting, protocol, source, results;
  std::vector<TableCell> cells;  ///< one per column of the table
};

struct FilledTable {
  const PaperTable* table;
  std::vector<TableRow> rows;
  bool simulated() const;  ///< whether any cell is
};

/// Fills the published rows: each run goes to the row of its method that is nearest in variant,
/// voxel size, range, delay and protocol; runs of methods without a published row follow at the
/// end, among them always the method of preset `best`. A HeLiMOS run over all labelled scans
/// also gives the numbers of the test split.
FilledTable fill_table(const PaperTable& table, const std::vector<PublishedCell>& published,
                       const std::vector<ResultSet>& runs);

/// Returns a sentence for each result that belongs in no cell of the table.
std::vector<std::string> left_out(const PaperTable& table, const std::vector<ResultSet>& runs);

}  // namespace mosbench
