#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/report/scan_choice.hpp"

namespace mosbench {

struct ReportOptions {
  std::optional<std::filesystem::path> dataset_root;  ///< default: where each run read its scans
  ScanChoice scans{"auto"};
  double max_mb = 25.0;  ///< of the file, 1e6 bytes; scans are left out to stay below
};

/// A page and remarks about it.
struct Report {
  std::string html;
  std::size_t results = 0;
  std::vector<std::string> remarks;  ///< a sentence for each sequence with scans left out
};

/// Builds one self-contained page about the results in and below `inputs`. Equal results and scans
/// give equal bytes. Throws DataError as read_results and ResultScans do, UsageError when the
/// numbers alone exceed `max_mb`.
Report build_report(const std::vector<std::filesystem::path>& inputs, const ReportOptions& options);

}  // namespace mosbench
