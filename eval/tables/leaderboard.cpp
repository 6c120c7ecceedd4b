#include "eval/tables/leaderboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "datasets/sequence/reading.hpp"
#include "datasets/text/errors.hpp"
#include "eval/statistics/run_statistics.hpp"

namespace mosbench {
namespace {

/// Settings of one run, and whose they are: only those of one owner say the same by one name.
struct OwnedSettings {
  std::string owner;
  RecordedSettings values = {};
};

OwnedSettings of_method(const Result& result) {
  OwnedSettings settings{result.method, result.settings.value_or(RecordedSettings{})};
  if (!result.settings && !result.setting.empty()) settings.values.set("setting", result.setting);
  return settings;
}

OwnedSettings of_poses(const Result& result) {
  OwnedSettings settings{result.method};
  const std::string source = reading_statement(result, "poses");
  if (result.from.odometry) {
    settings.values.set("poses", result.from.odometry->name);
  } else if (!source.empty()) {
    std::string poses(source == kStaticPoses ? kStaticPoses : "as given");
    if (!reading_statement(result, "pose_refinement").empty()) poses += ", refined";
    settings.values.set("poses", poses);
  }
  return settings;
}

OwnedSettings of_disturbance(const Result& result) {
  OwnedSettings settings{result.method};
  const std::string perturb = mark_of(result).disturbed;
  settings.values.set("perturb", perturb.empty() ? "none" : perturb);
  return settings;
}

OwnedSettings of_odometry(const Result& result) {
  if (!result.from.odometry) return {""};
  const OdometryDone& odometry = *result.from.odometry;
  OwnedSettings settings{odometry.name};
  for (const auto& [name, value] : odometry.settings.all()) {
    settings.values.set("odometry." + name, value);
  }
  if (!odometry.map.empty()) settings.values.set("odometry.map", odometry.map);
  return settings;
}

bool are_same(const SettingValue* one, const SettingValue* other) {
  if (one == nullptr || other == nullptr) return one == other;
  return are_equal(*one, *other);
}

bool differs(const std::vector<OwnedSettings>& runs, const std::string& name) {
  const bool has_all = std::ranges::none_of(
      runs, [&](const OwnedSettings& run) { return run.values.find(name) == nullptr; });
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const bool comparable = has_all || runs[a].owner == runs[b].owner;
      if (comparable && !are_same(runs[a].values.find(name), runs[b].values.find(name))) {
        return true;
      }
    }
  }
  return false;
}

std::vector<std::string> names_in(const std::vector<OwnedSettings>& runs) {
  std::vector<std::string> names;
  for (const OwnedSettings& run : runs) {
    for (const auto& [name, value] : run.values.all()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

bool lacks_truth(const Result& sequence) { return counted_scans(sequence).empty(); }

void check_has_truth(const ResultSet& run) {
  const auto unscored = std::ranges::find_if(run.sequences, lacks_truth);
  if (unscored == run.sequences.end()) return;
  throw DataError(unscored->file, "has no scan with truth", "a run that was scored, or --no-truth");
}

/// Methods are ranked with the poses that they were run with.
bool may_differ(const Unlike& unlike) {
  return unlike.kind == Unlike::Kind::kSetting || unlike.kind == Unlike::Kind::kPoses;
}

/// Returns why two runs cannot stand in one leaderboard.
std::vector<Unlike> obstacles(const PairedRuns& paired) {
  std::vector<Unlike> unlike = paired.unlike;
  std::erase_if(unlike, [](const Unlike& other) {
    return may_differ(other) || other.kind == Unlike::Kind::kScans;
  });
  return unlike;
}

void check_is_like(const ResultSet& first, const ResultSet& run) {
  const PairedRuns paired = pair_runs(first, run);
  const std::vector<Unlike> unlike = obstacles(paired);
  if (unlike.empty() && !paired.scans.empty()) return;
  const std::string why = unlike.empty() ? "they have no scan in common" : unlike_text(unlike);
  throw DataError(run.front().file, "is not like " + first.front().file.string() + ": " + why,
                  "runs with the same protocol, range, scans and truth");
}

std::vector<std::string> sequences_of(const std::vector<ResultSet>& runs) {
  std::set<SequenceName> names;
  for (const ResultSet& run : runs) {
    for (const Result& sequence : run.sequences) names.insert(sequence.sequence);
  }
  std::vector<std::string> texts;
  for (const SequenceName& name : names) texts.push_back(name.text());
  return texts;
}

/// Mean over all scans; nothing where a sequence was not timed, as of `mosbench score`.
std::optional<double> ms_per_scan(const ResultSet& run) {
  double sum_ms = 0.0, scans = 0.0;
  for (const Result& sequence : run.sequences) {
    const std::optional<double> ms = method_ms_per_scan(sequence);
    if (!ms) return std::nullopt;
    const auto count = static_cast<double>(sequence.scans.size());
    sum_ms += count * *ms;
    scans += count;
  }
  return sum_ms / scans;
}

std::optional<double> memory_mb(const ResultSet& run) {
  std::optional<double> most_mib;
  for (const Result& sequence : run.sequences) {
    most_mib = std::max(most_mib, most_resident_mib(sequence));
  }
  return most_mib ? std::optional(*most_mib * 1.048576) : std::nullopt;
}

LeaderboardRow row_of(const ResultSet& run, const std::vector<std::string>& sequences) {
  LeaderboardRow row;
  row.run = &run;
  std::vector<Standing> standings = standings_of(run);
  bool is_complete = missing_predictions(run.sequences) == 0;
  for (const std::string& name : sequences) {
    const auto found = std::ranges::find(
        run.sequences, name, [](const Result& sequence) { return sequence.sequence.text(); });
    is_complete = is_complete && found != run.sequences.end();
    std::optional<Estimates>& estimates = row.sequences.emplace_back();
    Standing& standing = row.sequence_standing.emplace_back();
    if (found == run.sequences.end()) continue;
    standing = std::move(standings[static_cast<std::size_t>(found - run.sequences.begin())]);
    estimates = estimate({&*found, 1});
  }
  if (is_complete) row.all = estimate(run.sequences);
  row.standing = std::move(standings.back());
  row.ms_per_scan = ms_per_scan(run);
  row.memory_mb = memory_mb(run);
  return row;
}

std::optional<double> iou_of(const LeaderboardRow& row) {
  return row.all ? (*row.all)[Metric::kIou].value : std::nullopt;
}

void mark_front(std::vector<LeaderboardRow>& rows) {
  std::vector<IouAndTime> runs;
  for (const LeaderboardRow& row : rows) runs.push_back({iou_of(row), row.ms_per_scan});
  const std::vector<bool> front = pareto_front(runs);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].is_on_front = front[i];
}

/// Names a row by its method, and by its number where another row is of the same one.
std::string name_of(const Leaderboard& board, const LeaderboardRow& row) {
  const std::string& method = row.run->front().method;
  const auto rows = std::ranges::count(
      board.rows, method, [](const LeaderboardRow& other) { return other.run->front().method; });
  return rows == 1 ? method : fmt::format("{} (row {})", method, &row - board.rows.data() + 1);
}

/// Takes the difference of a row to the first, and says what is wrong with its scans beside those.
void compare_with_first(Leaderboard& board, LeaderboardRow& row) {
  const LeaderboardRow& first = board.rows.front();
  PairedRuns paired = pair_runs(*first.run, *row.run);
  for (const Unlike& unlike : paired.unlike) {
    if (unlike.kind != Unlike::Kind::kPoses) continue;
    board.remarks.push_back(fmt::format("{} and {}: {}", name_of(board, first), name_of(board, row),
                                        unlike_text({unlike})));
  }
  std::erase_if(paired.unlike, may_differ);
  if (paired.unlike.empty()) {
    row.to_first = paired_difference(*first.run->front().protocol, paired.first, paired.second,
                                     paired.spacing)[Metric::kIou];
    return;
  }
  board.remarks.push_back(fmt::format("{} is not compared with {}: {}", name_of(board, row),
                                      name_of(board, first), unlike_text(paired.unlike)));
}

/// Says in which respect the times of the runs cannot be compared.
void remark_on_times(const std::vector<ResultSet>& runs, std::vector<std::string>& remarks) {
  std::set<unsigned> threads;
  std::set<std::string> processors;
  for (const ResultSet& run : runs) {
    for (const Result& sequence : run.sequences) {
      if (!sequence.timing || sequence.timing->threads == 0) continue;
      threads.insert(sequence.timing->threads);
      processors.insert(sequence.from.machine.value_or(Machine{}).processor);
    }
  }
  if (threads.size() > 1) {
    remarks.push_back(fmt::format("ms per scan are of different numbers of threads: {}",
                                  fmt::join(threads, ", ")));
  }
  if (processors.size() > 1) {
    remarks.push_back(
        fmt::format("ms per scan are of different processors: {}", fmt::join(processors, ", ")));
  }
}

void add_settings_and_doubts(Leaderboard& board) {
  std::vector<const ResultSet*> runs;
  std::vector<Doubt> doubts;
  for (const LeaderboardRow& row : board.rows) {
    runs.push_back(row.run);
    for (const std::string& warning : row.standing.doubts) {
      doubts.push_back({name_of(board, row), warning});
    }
  }
  board.doubts = told(doubts);
  board.differing = differing_settings(runs);
}

}  // namespace

std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs) {
  std::vector<DifferingSetting> differing;
  for (const auto settings_of : {of_method, of_poses, of_disturbance, of_odometry}) {
    std::vector<OwnedSettings> owned;
    for (const ResultSet* run : runs) owned.push_back(settings_of(run->front()));
    for (const std::string& name : names_in(owned)) {
      if (!differs(owned, name)) continue;
      DifferingSetting& setting = differing.emplace_back(DifferingSetting{name, {}});
      for (const OwnedSettings& run : owned) {
        const SettingValue* value = run.values.find(name);
        setting.values.push_back(value == nullptr ? std::nullopt : std::optional(*value));
      }
    }
  }
  return differing;
}

void add_folders_of_twins(Leaderboard& board) {
  const auto looks_like = [&](std::size_t a, std::size_t b) {
    return board.rows[a].run->front().method == board.rows[b].run->front().method &&
           std::ranges::all_of(board.differing, [&](const DifferingSetting& setting) {
             return setting.values[a] == setting.values[b];
           });
  };
  bool any = false;
  DifferingSetting folders{"folder", {}};
  for (std::size_t a = 0; a < board.rows.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) any = any || looks_like(a, b);
    const Result& first = board.rows[a].run->front();
    folders.values.emplace_back(folder_of_run(first.folder(), first.sequence).string());
  }
  if (any) board.differing.insert(board.differing.begin(), std::move(folders));
}

std::vector<std::vector<ResultSet>> comparable_runs(const std::vector<ResultSet>& runs) {
  std::vector<std::vector<ResultSet>> groups;
  for (const ResultSet& run : runs) {
    if (std::ranges::any_of(run.sequences, lacks_truth)) continue;
    const auto group = std::ranges::find_if(groups, [&](const std::vector<ResultSet>& known) {
      const PairedRuns paired = pair_runs(known.front(), run);
      return !paired.scans.empty() && obstacles(paired).empty();
    });
    if (group == groups.end()) {
      groups.push_back({run});
    } else {
      group->push_back(run);
    }
  }
  return groups;
}

Leaderboard leaderboard_of(const std::vector<ResultSet>& runs, RowOrder order) {
  Leaderboard board;
  board.sequences = sequences_of(runs);
  for (const ResultSet& run : runs) {
    check_has_truth(run);
    check_is_like(runs.front(), run);
    board.rows.push_back(row_of(run, board.sequences));
  }
  if (order == RowOrder::kIou) std::ranges::stable_sort(board.rows, std::greater(), iou_of);
  add_settings_and_doubts(board);
  mark_front(board.rows);
  remark_on_times(runs, board.remarks);
  for (std::size_t i = 1; board.rows.front().all && i < board.rows.size(); ++i) {
    compare_with_first(board, board.rows[i]);
  }
  return board;
}

}  // namespace mosbench
