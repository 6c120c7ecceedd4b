#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A number that somebody published, with all that decides whether another compares with it.
struct PublishedCell {
  std::string table;    ///< I, II, III, apollo, moe, mdetector
  std::string section;  ///< of the table: "range 20 m", "test split"
  std::string method;
  std::string setting;  ///< in words
  /// Of the HMM-MOS rows, so far as told.
  std::string variant;
  std::optional<double> voxel_size_m, max_range_m;
  std::optional<int> delay_scans;
  std::string column;
  std::string iou_percent;  ///< as printed; its digits tell how it was rounded
  std::string protocol;     ///< by which it was scored; "not stated" where the source does not tell
  std::string source;
  std::string note;

  double iou() const;  ///< fraction
};

/// Rows of results/published.csv: no quotes, so no commas within cells. Throws DataError with the
/// line.
std::vector<PublishedCell> parse_published(std::string_view text,
                                           const std::filesystem::path& file);

/// The rows of results/published.csv as they were when the program was built.
std::vector<PublishedCell> built_in_cells();

}  // namespace mosbench
