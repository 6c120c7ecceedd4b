#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/report/scan_choice.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

// Embedded by CMakeLists.txt: the page without its content, as scripts/build_report.sh made it.
std::string_view report_asset();
/// The page of `mosbench rank JOB.yaml --as html`, made likewise.
std::string_view study_asset();

/// Returns the parts of a page before and after the content.
std::pair<std::string_view, std::string_view> parts_of_page(std::string_view asset);

/// Returns JSON for a script element: no string of it can close its element or open another.
std::string script_json(const nlohmann::ordered_json& json);

/// Returns a page with its content, and with blocks of text named block-0, block-1, ...
std::string filled_page(std::string_view asset, const nlohmann::ordered_json& content,
                        const std::vector<std::string>& blocks = {});

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
