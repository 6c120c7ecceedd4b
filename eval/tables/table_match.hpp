#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/results/result_set.hpp"
#include "eval/tables/paper_tables.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// The published cells of one method, setting and section.
struct PublishedRow {
  std::vector<PublishedCell> cells;  ///< at least one
};

/// The rows of a table in the order in which they were published.
std::vector<PublishedRow> published_rows(const PaperTable& table,
                                         const std::vector<PublishedCell>& published);

/// Whether the row is of the method that `mosbench run` implements.
bool is_own(const PublishedCell& cell);

/// In what the run differs from how the published number came about: variant, voxel size, range,
/// delay, setting in words, protocol.
std::vector<std::string> mismatches(const ResultSet& run, const PublishedCell& cell);

/// The row of the run's method with the fewest mismatches; the first of equals.
std::optional<std::size_t> nearest_row(const ResultSet& run, const std::vector<PublishedRow>& rows);

/// The runs of the table's data set, and for each HeLiMOS run over all labelled scans the same
/// labels counted over the test split.
std::vector<ResultSet> with_splits(const PaperTable& table, const std::vector<ResultSet>& runs);

}  // namespace mosbench
