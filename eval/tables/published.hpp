#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// A published number, with everything that decides whether a measured one is comparable.
struct PublishedCell {
  std::string table;    ///< I, II, III, apollo, moe, mdetector
  std::string section;  ///< part of the table: "range 20 m", "test split"
  std::string method;
  std::string setting;  ///< in words
  /// Only of methods of mosbench, where the source states it: a value of the setting `variant`, or
  /// a setting and its value as in "level=object".
  std::string variant;
  std::optional<double> voxel_size_m, max_range_m;
  std::optional<int> delay_scans;
  std::string column;
  std::string iou_percent;  ///< as printed; its digits give the rounding
  std::string protocol;     ///< "not stated" where the source does not name one
  std::string source;
  std::string note;

  double iou() const;  ///< fraction
};

/// A setting of a method and its value.
struct PublishedVariant {
  std::string setting, value;
};
PublishedVariant variant_of(const PublishedCell& cell);

/// Parses results/published.csv, which has no quotes, hence no commas within cells. Throws
/// DataError with the line.
std::vector<PublishedCell> parse_published(std::string_view text,
                                           const std::filesystem::path& file);

/// Returns the rows of results/published.csv as of when the program was built.
std::vector<PublishedCell> built_in_cells();

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
