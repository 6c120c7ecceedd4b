#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// A column of a published table: which sequences it is over and how many labelled scans they have
/// in the real data set.
struct TableColumn {
  std::string_view name;
  std::vector<std::string_view> sequences;  ///< names, or a folder that holds any number of them
  std::optional<std::size_t> scans;         ///< under `scans_protocol`, where that is known
  std::string_view scans_protocol = "";     ///< empty: under every protocol
};

/// How a published table is built from result files, and how its empty cells are filled.
struct PaperTable {
  std::string_view name;
  std::string_view title;
  DatasetKind dataset;
  std::string_view averaging;
  std::vector<TableColumn> columns;
  std::string_view download;  ///< what to get, and from whom
};

std::span<const PaperTable> paper_tables();
/// In upper or lower case. Throws UsageError naming all tables.
const PaperTable& paper_table_named(std::string_view name);

/// Whether a number of the sequence belongs in the column, or in any of the table.
bool is_about(const TableColumn& column, const std::string& sequence);
bool is_about(const PaperTable& table, const std::string& sequence);

}  // namespace mosbench
