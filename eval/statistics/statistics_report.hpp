#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/result/result.hpp"
#include "eval/statistics/run_statistics.hpp"

namespace mosbench {

/// Returns a cell of it.
Spread spread_of(const Estimate& estimate);

/// {"iou": {"value", "standard_error", "low", "high"}, ...}, undefined as null.
nlohmann::ordered_json to_json(const Estimates& estimates);
/// Adds "p_value" and "smallest_detectable" to the same members.
nlohmann::ordered_json to_json(const Difference& difference);
nlohmann::ordered_json to_json(const Differences& differences);

/// "HMM-MOS, 0.25 m; data set doals, protocol doals-hmm".
std::string headline(const ResultSet& set);

/// Returns method, protocol, range, data set and whether the input is simulated.
nlohmann::ordered_json provenance_json(const ResultSet& set);

/// Says the estimates of each sequence and of all, in CSV counts and metrics of each scan; with
/// `per_scan` JSON has those, too.
Answer statistics_answer(const ResultSet& set, bool per_scan);

/// Describes the second run minus the first.
Answer difference_answer(const ResultSet& first, const ResultSet& second, const PairedRuns& paired);

/// Says the verdict and a row per check. The paired interval is shown under every rule: it says
/// whether other scans like these would show the difference.
Sheet gate_sheet(const GateResult& result);

/// Says what both runs cost; without rows where that is not known.
Sheet cost_sheet(const GateResult& result);

/// Returns one per check, and per cost that has a limit.
std::vector<CheckResult> gate_checks(const GateResult& result);

nlohmann::ordered_json to_json(const GateResult& result);

}  // namespace mosbench
