#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/cli/run_job.hpp"
#include "eval/tables/leaderboard_print.hpp"

namespace mosbench {
namespace {

struct RankFlags {
  std::vector<std::string> runs;
  std::string order = "iou";
  JobFlags job;
};

Answer rank(RankFlags options) {
  if (options.runs.size() == 1 && is_job(options.runs.front())) {
    options.job.file = options.runs.front();
    return rank_job(options.job);
  }
  check_output(options.job.output);
  std::vector<ResultSet> runs;
  for (const std::string& path : options.runs) {
    for (ResultSet& run : load_runs_of_folders(path)) runs.push_back(std::move(run));
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
  command
      .add_option("RUNS", options->runs,
                  "Folders of results, or JOB.yaml, as given to `mosbench run`")
      ->type_name("PATH")
      ->required();
  command.add_option("--order", options->order, "Best IoU first, or as RUNS are given")
      ->check(CLI::IsMember({"iou", "given"}))
      ->capture_default_str();
  command
      .add_option("--out", options->job.out,
                  "Folder of the results of JOB.yaml (default: results/runs/<its name>)")
      ->type_name("DIR");
  command.add_option("-o", options->job.output, "File of the table; - is stdout")
      ->type_name("FILE");
  return [options] { return rank(*options); };
}

}  // namespace mosbench
