#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/results/result_set.hpp"
#include "eval/statistics/bootstrap.hpp"
#include "eval/tables/paper_tables.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// How a measured value stands to the published one.
enum class Verdict {
  kPublishedOnly,  ///< nothing was measured
  kMeasuredOnly,   ///< nothing was published
  kWithin,         ///< the published value lies in the interval, up to its rounding
  kOutside,
  kNotComparable  ///< the two are of different things; `reasons` says which
};
std::string_view to_string(Verdict verdict);

struct TableCell {
  std::string column;
  std::optional<PublishedCell> published;
  std::optional<Estimate> measured;
  std::optional<double> difference;  ///< measured - published, fraction
  Verdict verdict = Verdict::kPublishedOnly;
  std::vector<std::string> sequences;  ///< measured ones, with the scene of simulated ones
  std::vector<std::string> reasons;    ///< why not comparable, or what to download and run
};

/// A method with its setting; `results` names the folder when something was measured.
struct TableRow {
  std::string section, method, setting, protocol, source, results;
  std::vector<TableCell> cells;  ///< one per column of the table
};

struct FilledTable {
  const PaperTable* table;
  std::vector<TableRow> rows;
};

/// The published rows, each run beside the row of its method that it comes nearest to in variant,
/// voxel size, range, delay and protocol; runs of methods without published row stand by themselves
/// at the end. A HeLiMOS run over all labelled scans gives the numbers of the test split, too.
FilledTable fill_table(const PaperTable& table, const std::vector<PublishedCell>& published,
                       const std::vector<ResultSet>& runs);

/// A sentence on each result that no cell of the table is about.
std::vector<std::string> left_out(const PaperTable& table, const std::vector<ResultSet>& runs);

}  // namespace mosbench
