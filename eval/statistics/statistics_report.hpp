#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/results/result_set.hpp"
#include "eval/statistics/intervals.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

/// Metrics of a run with intervals: each sequence alone, and all as the protocol aggregates them.
struct RunStatistics {
  std::vector<Estimates> sequences;  ///< in the order of the set
  Estimates all;
};

RunStatistics run_statistics(const ResultSet& set);

/// Returns "[62.10, 63.95]" in percent, "none" without interval; `style` is that of fmt.
std::string interval_text(const std::optional<Interval>& interval, const char* style);

/// {"iou": {"value", "standard_error", "low", "high"}, ...}, undefined as null.
nlohmann::ordered_json to_json(const Estimates& estimates);
/// Adds "p_value" and "smallest_detectable" to the same members.
nlohmann::ordered_json to_json(const Difference& difference);
nlohmann::ordered_json to_json(const Differences& differences);

/// Returns method, protocol, range, data set and whether the input is simulated.
nlohmann::ordered_json provenance_json(const ResultSet& set);

/// Returns provenance and the estimates of each sequence and of all; with `per_scan` also counts
/// and metrics of each scan.
nlohmann::ordered_json statistics_json(const ResultSet& set, bool per_scan);
/// Formats a row per counted scan: sequence, scan, points, counts and metrics; undefined ones
/// empty.
std::string scan_table_csv(const ResultSet& set);
std::string statistics_text(const ResultSet& set);

/// Describes the second run minus the first.
nlohmann::ordered_json difference_json(const ResultSet& first, const ResultSet& second,
                                       const PairedRuns& paired);
std::string difference_text(const ResultSet& first, const ResultSet& second,
                            const PairedRuns& paired);

}  // namespace mosbench
