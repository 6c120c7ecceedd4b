#pragma once

#include <mosbench/method.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/result/result_set.hpp"
#include "eval/tables/paper_tables.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// The published cells of one method, setting and section.
struct PublishedRow {
  std::vector<PublishedCell> cells;  ///< at least one
};

/// Returns the rows of a table in the order of publication.
std::vector<PublishedRow> published_rows(const PaperTable& table,
                                         const std::vector<PublishedCell>& published);

/// Returns the method of `mosbench run` that the row is of; null for other programs.
const MethodKind* own_method(const PublishedCell& cell);

/// Lists how the run differs from the published one: variant, voxel size, range, delay, setting in
/// words, protocol.
std::vector<std::string> mismatches(const ResultSet& run, const PublishedCell& cell);

/// Returns the row of the run's method with the fewest mismatches; the first of equal ones.
std::optional<std::size_t> nearest_row(const ResultSet& run, const std::vector<PublishedRow>& rows);

/// Returns the runs of the table's data set and, for each HeLiMOS run over all labelled scans, the
/// same labels counted over the test split.
std::vector<ResultSet> with_splits(const PaperTable& table, const std::vector<ResultSet>& runs);

}  // namespace mosbench
