#include "eval/report/report_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "eval/report/curve_report.hpp"
#include "eval/tables/leaderboard_print.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Where a run lies, whatever the folder from which the program was called.
std::filesystem::path place_of(const Result& result) {
  const auto folder = std::filesystem::absolute(result.folder() / "").lexically_normal();
  return folder_of_run(folder.parent_path(), result.sequence);
}

const ReportRun& run_with(const std::vector<ReportRun>& runs, const Result& sequence) {
  return *std::ranges::find(runs, sequence.file,
                            [](const ReportRun& run) { return run.set.front().file; });
}

/// The table shows no more of a sequence.
void keep_iou(ordered_json& metrics) {
  if (metrics.is_object()) metrics = {{"iou", metrics.at("iou")}};
}

ordered_json leaderboard_json(const std::vector<ResultSet>& group,
                              const std::vector<ReportRun>& runs) {
  const Leaderboard board = leaderboard_of(group);
  ordered_json json = to_json(board);
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    ordered_json& row = json["rows"][r];
    const ReportRun& run = run_with(runs, board.rows[r].run->front());
    row["run"] = run.name;
    row["results"] = run.results;
    for (const char* of_results : {"path", "config", "code", "predictions", "simulated"}) {
      row.erase(of_results);
    }
    for (ordered_json& sequence : row["sequences"]) keep_iou(sequence["metrics"]);
  }
  return json;
}

/// Makes "base" of two runs "base (1)" and "base (2)".
void number_equal_names(std::vector<ReportRun>& runs) {
  std::map<std::string, int> uses, seen;
  for (const ReportRun& run : runs) ++uses[run.name];
  for (ReportRun& run : runs) {
    if (uses[run.name] > 1) run.name = fmt::format("{} ({})", run.name, ++seen[run.name]);
  }
}

bool has_curve(const ReportRun& run, const std::vector<std::optional<ResultScans>>& sources) {
  return std::ranges::all_of(run.results, [&](std::size_t i) {
    return sources[i] && sources[i]->has_scores() &&
           !scans_with_truth(sources[i]->sequence()).empty();
  });
}

}  // namespace

std::string run_name(const Result& result) { return place_of(result).filename().string(); }

std::vector<ReportRun> runs_of(const std::vector<Result>& results) {
  struct Place {
    std::filesystem::path folder;
    std::vector<Result> sequences;
  };
  std::vector<Place> places;
  for (const Result& result : results) {
    const auto known = std::ranges::find(places, place_of(result), &Place::folder);
    Place& place =
        known == places.end() ? places.emplace_back(Place{place_of(result), {}}) : *known;
    place.sequences.push_back(result);
  }
  std::vector<ReportRun> runs;
  for (Place& place : places) {
    for (ResultSet& set : sorted_into_runs(std::move(place.sequences), place.folder)) {
      ReportRun& run = runs.emplace_back(ReportRun{place.folder.filename().string(), {}, {}});
      for (const Result& sequence : set.sequences) {
        const auto found = std::ranges::find(results, sequence.file, &Result::file);
        run.results.push_back(static_cast<std::size_t>(found - results.begin()));
      }
      run.set = std::move(set);
    }
  }
  number_equal_names(runs);
  return runs;
}

ordered_json leaderboards_of(const std::vector<ReportRun>& runs) {
  std::vector<ResultSet> sets;
  for (const ReportRun& run : runs) sets.push_back(run.set);
  ordered_json boards = ordered_json::array();
  for (const std::vector<ResultSet>& group : comparable_runs(sets)) {
    if (group.size() > 1) boards.push_back(leaderboard_json(group, runs));
  }
  return boards;
}

ordered_json curves_of(const std::vector<ReportRun>& runs, const std::vector<Result>& results,
                       const std::vector<std::optional<ResultScans>>& sources) {
  ordered_json curves = ordered_json::array();
  for (const ReportRun& run : runs) {
    if (!has_curve(run, sources)) continue;
    ScoreCounts counts;
    for (const std::size_t i : run.results) add_counted_scans(results[i], *sources[i], counts);
    try {
      ordered_json curve = {{"run", run.name}, {"results", run.results}};
      curve.update(drawn_curve_json(counts.curve()));
      curves.push_back(std::move(curve));
    } catch (const std::domain_error&) {  // no point moves
    }
  }
  return curves;
}

}  // namespace mosbench
