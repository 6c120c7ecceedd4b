#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/tables/leaderboard_print.hpp"

namespace mosbench {
namespace {

constexpr const char* kRankFooter =
    R"(RUNS are folders that `mosbench run` (also with several methods) or `mosbench score --out` wrote.
Prints a row per run, the best first: the settings in which runs of one method differ (the folder of
runs that differ in none), IoU with its 95 % interval over all sequences as the protocol aggregates
them and of each sequence, precision, recall, milliseconds of the method per scan, and the most
memory that the process held after a scan (of a program behind exec: not that of the program). A
star marks the Pareto front of IoU against time. The last column is the paired difference to the
first row with its interval; where the scans cannot tell, it says why. With --order given the rows
come as RUNS are given, so that the first is what the others are compared with. Runs of another
protocol, range, scans or truth are refused (exit code 3); a run that lacks a sequence, or
predictions, is shown, but not ranked. Compare times of runs only that one machine made while it did
nothing else.

Examples:
  mosbench rank results/runs/08
  mosbench rank results/runs/online results/runs/delay-5 results/runs/delay-10 --order given
  mosbench rank results/runs/08 results/runs/4dmos --as latex > leaderboard.tex
  mosbench rank results/runs/08/dynablox results/runs/08/yoon --as csv)";

struct RankFlags {
  std::vector<std::string> runs;
  std::string order = "iou";
};

Answer rank(const RankFlags& options) {
  std::vector<ResultSet> runs;
  for (const std::string& path : options.runs) {
    for (ResultSet& run : load_runs_of_folders(path)) runs.push_back(std::move(run));
  }
  Leaderboard board =
      leaderboard_of(runs, options.order == "given" ? RowOrder::kGiven : RowOrder::kIou);
  add_folders_of_twins(board);
  return leaderboard_answer(board);
}

}  // namespace

CommandRun add_rank(CLI::App& command) {
  auto options = std::make_shared<RankFlags>();
  command.add_option("RUNS", options->runs, "Folders of results")->type_name("DIR")->required();
  command.add_option("--order", options->order, "Best IoU first, or as RUNS are given")
      ->check(CLI::IsMember({"iou", "given"}))
      ->capture_default_str();
  command.footer(kRankFooter);
  return [options] { return rank(*options); };
}

}  // namespace mosbench
