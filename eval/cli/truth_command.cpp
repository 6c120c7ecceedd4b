#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/result/result.hpp"
#include "eval/result/tell.hpp"
#include "eval/truth/review.hpp"
#include "eval/truth/track_counts.hpp"
#include "eval/truth/truth_labels.hpp"

namespace mosbench {
namespace {

struct TruthFlags : JobWords {
  std::string action;
  std::vector<std::string> results;
  std::optional<std::filesystem::path> out, data;
  unsigned threads = hardware_threads();
};

constexpr std::size_t kMostRows = 20;

/// What labels are worth, by the tracks that are decided.
Sheet estimates(const TruthFolder& truth, const std::vector<std::string>& results,
                const std::optional<std::filesystem::path>& data) {
  Sheet sheet{.title = "IoU if every track were decided, estimated",
              .columns = {{"labels", Unit::kText}, {"IoU", Unit::kPercent, 1}}};
  const auto add = [&](const std::string& labels, const TrackCounts& counts) {
    const auto iou = sampled_iou(truth.tracks, truth.decided, counts);
    if (iou) sheet.rows.push_back({labels, *iou});
  };
  add("as written now", counts_of_written(truth));
  for (const std::string& path : results) {
    for (const ResultSet& run : load_runs_of_folders(path)) {
      add(method_words(run.front()), counts_of_result(truth, run, data));
    }
  }
  sheet.notes = {
      "right only if tracks are decided in this order: half of them are drawn at random"};
  return sheet;
}

/// The tracks that are to be decided next, and how many.
Answer status_answer(const std::filesystem::path& folder, const TruthFlags& flags = {}) {
  const TruthFolder truth = open_truth(folder);
  const std::vector<TruthTrack> left = truth.undecided();
  std::size_t scans = 0;
  for (const Result& run : truth.runs) scans += run.scans.size();
  Sheet sheet{.lead = {fmt::format("{} in {}, {} of them decided; {}",
                                   counted(truth.tracks.size(), "track"), counted(scans, "scan"),
                                   truth.decided.size(), left_text(left))},
              .columns = {{"track", Unit::kText},
                          {"scans", Unit::kText},
                          {"points"},
                          {"guess", Unit::kText},
                          {"doubt", Unit::kPercent, 0},
                          {"worth", Unit::kPercent, 2}}};
  for (const TruthTrack& track : left) {
    if (sheet.rows.size() == kMostRows) break;
    sheet.rows.push_back({track.id(), fmt::format("{} to {}", track.first_scan, track.last_scan),
                          std::uint64_t{track.points},
                          std::string(track.moves ? "moving" : "static"), track.doubt,
                          track.worth});
  }
  if (left.size() > kMostRows) {
    sheet.notes.push_back(fmt::format(
        "{} of {} undecided tracks are shown, in the order of decisions", kMostRows, left.size()));
  }
  for (const TruthTrack* track : truth.contradicted()) {
    sheet.notes.push_back(
        fmt::format("{} is decided {}, but {:.0f} % of the looks at it say {}: look again",
                    track->id(), track->moves ? "static" : "moving", 100 * (1 - track->doubt),
                    track->moves ? "moving" : "static"));
  }
  Answer answer{.standing = standing_of(ResultSet{folder, truth.runs}), .sheets = {sheet}};
  if (!truth.decided.empty()) answer.sheets.push_back(estimates(truth, flags.results, flags.data));
  return answer;
}

/// Throws UsageError where the tracks that decisions are about would be found anew.
void keep_decisions(const RunPlan& plan) {
  const std::size_t decisions = read_decisions(plan.out).size();
  const auto is_new = [](const PlannedSequence& planned) { return !planned.finished; };
  if (decisions == 0 || std::ranges::none_of(plan.sequences, is_new)) return;
  throw UsageError(fmt::format(
      "{}: holds {} on tracks whose files are not there any more, expected another -o, or no "
      "decisions.json",
      plan.out.string(), counted(decisions, "decision")));
}

Answer propose(TruthFlags flags) {
  if (!flags.out) throw UsageError("-o: is missing, expected the folder of the tracks");
  if (flags.data) throw UsageError("--data: is nothing for truth propose, expected DRIVE alone");
  flags.preset = "offline";
  // The longest window and nearest range: a track that is cut would be two decisions.
  flags.assignments = {"delay=all:3600", "min_range_m=0.5"};
  const RunPlan plan = plan_run(
      job_of(flags), {.out = flags.out, .threads = flags.threads, .scores = true, .objects = true});
  keep_decisions(plan);
  std::vector<Result> runs;
  for (const SequenceOutcome& outcome : execute_run(plan)) {
    runs.push_back(outcome.result);
    runs.back().file = outcome.folder / "result.json";
  }
  commit_file(tracks_file(plan.out), format_tracks(list_tracks(runs)));
  return status_answer(plan.out);
}

Answer write_answer(const TruthFlags& flags) {
  if (!flags.out) throw UsageError("--out: is missing, expected the folder of the labels");
  const TruthFolder truth = open_truth(flags.input);
  Sheet sheet{.columns = {{"sequence", Unit::kText},
                          {"scans"},
                          {"points"},
                          {"moving", Unit::kPercent, 2},
                          {"unsure", Unit::kPercent, 2},
                          {"by hand", Unit::kPercent, 2},
                          {"completed", Unit::kPercent, 2},
                          {"not looked at", Unit::kPercent, 2}}};
  for (const TruthShares& written : write_truth(truth, flags.data, *flags.out)) {
    const auto share = [&](std::size_t part) {
      return static_cast<double>(part) /
             static_cast<double>(std::max<std::size_t>(written.points, 1));
    };
    sheet.rows.push_back({written.sequence, std::uint64_t{written.scans},
                          std::uint64_t{written.points}, share(written.moving),
                          share(written.unsure), share(written.by_hand), share(written.completed),
                          share(written.guessed)});
  }
  sheet.notes = {fmt::format("{}; labels in {}", counted(truth.decided.size(), "decision"),
                             flags.out->string())};
  return {.standing = standing_of(ResultSet{truth.path, truth.runs}), .sheets = {sheet}};
}

Answer import_answer(const TruthFlags& flags) {
  if (!flags.out) throw UsageError("-o: is missing, expected the folder of the tracks");
  const FolderLock lock(*flags.out);  // a page that is open would not know of these decisions
  TruthFolder truth = open_truth(*flags.out);
  const TruthImport imported = import_truth(truth, flags.data, flags.input);
  Answer answer = status_answer(*flags.out);
  answer.sheets.front().notes.push_back(fmt::format(
      "{} by the labels in {}; {} of {} still differ{}", counted(imported.decisions, "decision"),
      flags.input.string(), imported.still_differ, counted(imported.points, "point"),
      imported.still_differ > 0 ? ": cut, split or paint tracks by mosbench truth review" : ""));
  return answer;
}

Answer truth_answer(const TruthFlags& flags, const CLI::App& command) {
  if (!flags.results.empty() && flags.action != "status") {
    throw UsageError("RESULTS: are nothing for truth " + flags.action + ", expected them left out");
  }
  if (flags.action == "propose") return propose(flags);
  constexpr std::array kOfTruth = {"--data", "--as", "--json"};
  const std::string given = given_words(command, [&](const CLI::Option& option) {
    if ((flags.action == "write" || flags.action == "import") && option.check_lname("out"))
      return false;
    return option.nonpositional() &&
           std::ranges::find(kOfTruth, option.get_name()) == kOfTruth.end();
  });
  if (!given.empty()) {
    throw UsageError(fmt::format("{}: is nothing for truth {}, expected it left out",
                                 given.substr(1), flags.action));
  }
  if (flags.action == "write") return write_answer(flags);
  if (flags.action == "import") return import_answer(flags);
  if (flags.action == "status") return status_answer(flags.input, flags);
  serve_review(flags.input, flags.data, [](const std::string& address) {
    tell(fmt::format("open {} in a browser; Ctrl-C ends, decisions are stored at once", address));
  });
  return {};
}

}  // namespace

CommandRun add_truth(CLI::App& command) {
  auto flags = std::make_shared<TruthFlags>();
  add(command, "ACTION", flags->action,
      "propose tracks of DRIVE; review them in a browser, tell the status of TRUTH, write its "
      "labels, or import corrected ones")
      ->required()
      ->check(CLI::IsMember({"propose", "review", "status", "write", "import"}));
  add_dataset_flags(command, *flags, "DRIVE");
  add(command, "RESULTS PATH", flags->results,
      "Of status: results of methods on the same scans, to estimate their IoU");
  add(command, "-o,--out DIR", flags->out,
      "Folder to write: of propose and import TRUTH, of write <sequence>/labels");
  add(command, "--data DIR", flags->data,
      "Of review, status, write and import: folder of the drive, where it was moved");
  add_odometry_flag(command, flags->odometry, "Find the poses by it instead of reading them");
  add_threads_flag(command, flags->threads);
  return [flags, &command] { return truth_answer(*flags, command); };
}

}  // namespace mosbench
