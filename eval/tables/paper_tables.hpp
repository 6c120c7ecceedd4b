#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// A column of a published table: its sequences and their number of labelled scans in the real data
/// set.
struct TableColumn {
  std::string_view name;
  std::vector<std::string_view> sequences;  ///< names, or folders of several sequences
  std::optional<std::size_t> scans;         ///< under `scans_protocol`, where known
  std::string_view scans_protocol = "";     ///< empty: under every protocol
};

/// How a published table is filled from result files.
struct PaperTable {
  std::string_view name;
  std::string_view title;
  DatasetKind dataset;
  std::string_view averaging;
  std::vector<TableColumn> columns;
  std::string_view download;  ///< what to download, and where
};

std::span<const PaperTable> paper_tables();
/// Ignores case. Throws UsageError naming all tables.
const PaperTable& paper_table_named(std::string_view name);

/// Whether the column, or any column of the table, contains the sequence.
bool contains(const TableColumn& column, const std::string& sequence);
bool contains(const PaperTable& table, const std::string& sequence);

}  // namespace mosbench
