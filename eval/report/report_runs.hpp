#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/result/result_scans.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {

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
