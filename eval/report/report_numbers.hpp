#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/result/result_scans.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {

/// Returns the metrics of a result with intervals, as `mosbench stats` does; null without truth.
nlohmann::ordered_json estimates_of(const Result& result);

/// Returns the breakdown of a result, as `mosbench breakdown` does; null without truth.
nlohmann::ordered_json breakdown_of(const ResultScans& scans);

/// Returns the summary of a result under every protocol, as `mosbench score --protocol all` does;
/// null without truth.
nlohmann::ordered_json protocols_of(const ResultScans& scans);

/// Returns the published tables with at least one cell measured by the results below `inputs`;
/// results on simulated data are not used.
nlohmann::ordered_json covered_tables(const std::vector<std::filesystem::path>& inputs);

/// The way of the sensor from above, in metres: `run_m`, [x, y] per scan of the poses of the run.
/// If the data set has other poses for the same scans: also `own_m`, the length `way_m` of that
/// path up to each scan, and the distance `off_m` of the run's positions to its; the run's first
/// pose is then moved onto the data set's.
nlohmann::ordered_json path_of(const Result& result, const ResultScans& scans);

/// Returns "mine" for results/runs/mine/00 of sequence 00; the folder's own name if it is not named
/// like its sequence.
std::string run_name(const Result& result);

/// The results of one run in a report.
struct ReportRun {
  std::string name;
  std::vector<std::size_t> results;  ///< positions in the report
  ResultSet set;
};

/// Sorts results into runs: those of one folder, method and setting, in the order of their first
/// result; equal names are numbered. Throws DataError as `sorted_into_runs`.
std::vector<ReportRun> runs_of(const std::vector<Result>& results);

/// Returns a leaderboard, as `mosbench leaderboard` prints it, for each group of at least two runs
/// on the same scans. Each row also holds its "run" and the positions of its "results".
nlohmann::ordered_json leaderboards_of(const std::vector<ReportRun>& runs);

/// Returns precision over recall, as `mosbench curve` does, of the runs that kept scores for all
/// their sequences and in whose truth a point moves, each with its "run" and "results". `sources`
/// are the scans of `results`, as far as they have labels.
nlohmann::ordered_json curves_of(const std::vector<ReportRun>& runs,
                                 const std::vector<Result>& results,
                                 const std::vector<std::optional<ResultScans>>& sources);

}  // namespace mosbench
