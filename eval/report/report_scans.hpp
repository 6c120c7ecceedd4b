#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/report/report.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

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
