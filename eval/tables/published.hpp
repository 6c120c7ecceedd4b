#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace mosbench
