#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/report/scan_choice.hpp"
#include "eval/result/result_scans.hpp"

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

/// The points of a report. Results of the same frames share one cloud, so that runs can be compared
/// point by point and positions are stored once.
struct ReportScans {
  nlohmann::ordered_json clouds = nlohmann::ordered_json::array();
  /// Per result its cloud, and per scan of that cloud the block with the outcomes, and those with
  /// the dynamic scores and the reasons when the run kept them.
  struct OfResult {
    std::size_t cloud = 0;
    std::vector<std::size_t> outcome_blocks;
    std::vector<std::size_t> score_blocks;
    std::vector<std::size_t> scans;  ///< indices of those scans, which rise
    std::vector<std::size_t> reason_blocks;
  };
  std::vector<OfResult> results;
  std::vector<std::string> blocks;  ///< see compressed_text
  std::vector<std::string> remarks;
};

/// Throws UsageError when `choice` wants no scan of any result although they have some.
void check_choice(const std::vector<Result>& results, const ScanChoice& choice);

/// Takes scans in the order in which they are wanted, from all clouds alternately, until the next
/// one would exceed `max_bytes`; throws UsageError when that leaves none. `sources` are the scans
/// of `results`, none for a result without points.
ReportScans choose_report_scans(const std::vector<Result>& results,
                                const std::vector<std::optional<ResultScans>>& sources,
                                const ScanChoice& choice, std::size_t max_bytes);

}  // namespace mosbench
