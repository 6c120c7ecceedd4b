#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/result/output.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/order_without_truth.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

struct RankFlags {
  std::vector<std::string> runs;
  std::string order = "iou";
  bool allow_stale = false, no_truth = false;
  JobFlags job;
};

/// What was done to the scans of a run: how they were disturbed, and of which simulation they are.
std::pair<std::string, std::string> scans_of(const ResultSet& run) {
  return {disturbance_of(run.front()), simulation_of(run.front())};
}

/// Leaves the cells of a study that are on the same scans, undisturbed if there are such; other
/// results all stay.
void keep_comparable_cells(std::vector<ResultSet>& runs) {
  std::optional<std::pair<std::string, std::string>> kept;
  for (const ResultSet& run : runs) {
    if (run.front().key.empty()) return;
    if (!kept || scans_of(run) < *kept) kept = scans_of(run);
  }
  const std::size_t left_out =
      std::erase_if(runs, [&](const ResultSet& run) { return scans_of(run) != *kept; });
  if (left_out == 0) return;
  tell(fmt::format("{} of a study on other scans left out, `mosbench rank` of its file shows them",
                   counted(left_out, "run")));
}

Answer rank(RankFlags options, const CLI::App& command) {
  check_answer_file(command, options.job.output);
  if (options.runs.size() == 1 && is_job(options.runs.front())) {
    if (options.no_truth) throw UsageError("--no-truth: is nothing for a job, expected runs");
    options.job.file = options.runs.front();
    return rank_job(options.job);
  }
  std::vector<ResultSet> runs;
  for (const std::string& path : options.runs) {
    for (ResultSet& run : load_runs_of_folders(path)) runs.push_back(std::move(run));
  }
  refuse_stale(runs, options.allow_stale);
  keep_comparable_cells(runs);
  if (options.no_truth) {
    Answer answer = order_without_truth(runs);
    answer.file = options.job.output;
    return answer;
  }
  Leaderboard board =
      leaderboard_of(runs, options.order == "given" ? RowOrder::kGiven : RowOrder::kIou);
  add_folders_of_twins(board);
  Answer answer = leaderboard_answer(board);
  answer.file = options.job.output;
  return answer;
}

}  // namespace

CommandRun add_rank(CLI::App& command) {
  auto options = std::make_shared<RankFlags>();
  add(command, "RUNS PATH", options->runs,
      "Folders of results, or JOB.yaml, as given to `mosbench run`")
      ->required();
  add(command, "--order", options->order, "Best IoU first, or as RUNS are given")
      ->check(CLI::IsMember({"iou", "given"}))
      ->capture_default_str();
  command.add_flag("--no-truth", options->no_truth,
                   "Order by what later scans show, not by truth: an order, not a score");
  add_stale_flag(command, options->allow_stale);
  add(command, "--out DIR", options->job.out,
      "Folder of the results of JOB.yaml (default: results/runs/<its name>)");
  add(command, "-o FILE", options->job.output, "File of the table; - is stdout");
  return [options, &command] { return rank(*options, command); };
}

}  // namespace mosbench
