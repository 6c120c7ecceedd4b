#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/report/report.hpp"
#include "eval/report/score_curve.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/tables/score_report.hpp"
#include "eval/tables/table_print.hpp"
#include "eval/trajectory/pose_errors.hpp"
#include "eval/trajectory/trajectory.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kListed = 50;  // objects, and false positives

/// Every protocol with its default range, that of the run with the run's range.
std::vector<ScoreRule> rules_beside(const ScoreRule& own) {
  std::vector<ScoreRule> rules;
  for (const Protocol& protocol : protocols()) {
    rules.push_back({&protocol, &protocol == own.protocol ? own.range : protocol.default_range});
  }
  return rules;
}

bool is_measured(const FilledTable& table) {
  return std::ranges::any_of(table.rows, [](const TableRow& row) {
    return std::ranges::any_of(row.cells,
                               [](const TableCell& cell) { return cell.measured.has_value(); });
  });
}

/// Returns the runs of recorded data; none of a folder that holds the same sequence and run twice,
/// because it is unclear which of the two a table should show.
std::vector<ResultSet> recorded_runs(const std::vector<std::filesystem::path>& inputs) {
  std::vector<ResultSet> runs;
  for (const std::filesystem::path& input : inputs) {
    try {
      for (ResultSet& run : load_result_sets(input)) {
        if (!run.front().is_simulated()) runs.push_back(std::move(run));
      }
    } catch (const DataError&) {
      continue;
    }
  }
  return runs;
}

using nlohmann::ordered_json;

/// To the millimetre, which no chart shows.
double rounded_m(double value_m) { return std::round(value_m * 1e3) / 1e3; }

ordered_json numbers(const std::vector<double>& values_m) {
  ordered_json json = ordered_json::array();
  for (const double value_m : values_m) json.push_back(rounded_m(value_m));
  return json;
}

ordered_json seen_from_above(const std::vector<Pose>& poses) {
  ordered_json json = ordered_json::array();
  for (const Pose& pose : poses) {
    json.push_back({rounded_m(pose.translation().x()), rounded_m(pose.translation().y())});
  }
  return json;
}

bool are_same_scans(const Sequence& one, const Sequence& other) {
  bool same = one.size() == other.size();
  for (std::size_t k = 0; same && k < one.size(); ++k) same = one.stem(k) == other.stem(k);
  return same;
}

/// The poses that the data set itself has for the scans of a run that took others. Nothing if the
/// run took these, or if they cannot be read.
std::optional<std::vector<Pose>> poses_passed_over(const Result& result, const ResultScans& scans) {
  Reading reading = reading_of(result);
  if (reading.has_own_poses()) return std::nullopt;
  reading.poses = OwnPoses{};
  reading.refine_poses = false;
  reading.pose_format.reset();
  reading.pose_frame.reset();
  reading.pose_direction.reset();
  try {
    const Dataset own =
        open_dataset(scans.dataset().root, {scans.dataset().kind, {result.sequence}, reading});
    const Sequence& sequence = *own.sequences.front();
    if (are_same_scans(sequence, scans.sequence())) return poses_of(sequence);
  } catch (const DataError&) {  // most runs take other poses because there are none
  }
  return std::nullopt;
}

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

ordered_json estimates_of(const Result& result) {
  if (counted_scans(result).empty()) return nullptr;
  return to_json(estimate({&result, 1}));
}

ordered_json breakdown_of(const ResultScans& scans) {
  const std::vector<std::size_t> wanted = scans.scored_scans();
  if (wanted.empty()) return nullptr;
  return to_json(break_down(scans.sequence(), wanted, scans.labels(),
                            {scans.rule().protocol, scans.rule().range, hardware_threads()}),
                 kListed);
}

ordered_json protocols_of(const ResultScans& scans) {
  const std::size_t labelled = scans_with_truth(scans.sequence()).size();
  if (labelled == 0 || scans.scored_scans().size() < labelled) return nullptr;
  const std::vector<ScoreRule> rules = rules_beside(scans.rule());
  const ScoreTask task{scans.source().path, scans.source().options, rules, std::nullopt,
                       hardware_threads()};
  return protocols_json(rules, score_dataset(scans.dataset(), task));
}

ordered_json covered_tables(const std::vector<std::filesystem::path>& inputs) {
  const std::vector<ResultSet> runs = recorded_runs(inputs);
  const auto published = built_in_cells();
  ordered_json tables = ordered_json::array();
  for (const PaperTable& table : paper_tables()) {
    const bool about_these = std::ranges::any_of(runs, [&](const ResultSet& run) {
      return run.front().dataset == to_string(table.dataset);
    });
    if (!about_these) continue;
    const FilledTable filled = fill_table(table, published, runs);
    if (is_measured(filled)) tables.push_back(to_json(filled));
  }
  return tables;
}

ordered_json path_of(const Result& result, const ResultScans& scans) {
  const std::vector<Pose> of_run = poses_of(scans.sequence());
  const auto own = poses_passed_over(result, scans);
  if (!own) return {{"run_m", seen_from_above(of_run)}};
  const std::vector<Pose> moved = aligned(of_run, *own, PathAlignment::kOrigin).value().poses;
  return {{"run_m", seen_from_above(moved)},
          {"own_m", seen_from_above(*own)},
          {"way_m", numbers(path_lengths_m(*own))},
          {"off_m", numbers(absolute_errors(*own, moved).translation_m)}};
}

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
    const std::optional<ScoreCurve> found = counts.curve();
    if (!found) continue;  // no point moves
    ordered_json curve = {{"run", run.name}, {"results", run.results}};
    curve.update(drawn_curve_json(*found));
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace mosbench
