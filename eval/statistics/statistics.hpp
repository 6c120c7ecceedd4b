#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/results/result_set.hpp"
#include "eval/statistics/bootstrap.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

/// One run with its uncertainty: each sequence by itself, and all as the protocol aggregates them.
struct RunStatistics {
  std::vector<Estimates> sequences;  ///< as in the set
  Estimates all;
};

RunStatistics run_statistics(const ResultSet& set);

/// {"iou": {"value", "standard_error", "low", "high"}, ...}, undefined as null.
nlohmann::ordered_json to_json(const Estimates& estimates);
/// The same with "p_value" and "smallest_detectable".
nlohmann::ordered_json to_json(const Differences& differences);

/// Who predicted, by what rules it was scored, and whether the input is simulated.
nlohmann::ordered_json provenance_json(const ResultSet& set);

/// Provenance, the estimates of each sequence and of all; with `per_scan` also the scans' counts
/// and metrics.
nlohmann::ordered_json statistics_json(const ResultSet& set, bool per_scan);
/// A row per counted scan: sequence, scan, points, counts and metrics; empty cells where undefined.
std::string scan_table_csv(const ResultSet& set);
std::string statistics_text(const ResultSet& set);

/// The second run minus the first.
nlohmann::ordered_json difference_json(const ResultSet& first, const ResultSet& second,
                                       const PairedRuns& paired);
std::string difference_text(const ResultSet& first, const ResultSet& second,
                            const PairedRuns& paired);

}  // namespace mosbench
