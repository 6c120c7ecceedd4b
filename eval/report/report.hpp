#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/report/scan_choice.hpp"

namespace mosbench {

struct ReportOptions {
  std::optional<std::filesystem::path> dataset_root;  ///< else where each run read its scans
  ScanChoice scans{"auto"};
  double max_mb = 25.0;  ///< of the file, 1e6 bytes; scans are left out to stay below
};

/// A page and what has to be said about it.
struct Report {
  std::string html;
  std::size_t results = 0;
  std::vector<std::string> remarks;  ///< one sentence per sequence of which scans were left out
};

/// One self-contained page about the results in and below `inputs`. Equal results and scans give
/// equal bytes. Throws DataError as find_results and ResultScans do, UsageError when `max_mb` has
/// no room for the numbers alone.
Report build_report(const std::vector<std::filesystem::path>& inputs, const ReportOptions& options);

}  // namespace mosbench
