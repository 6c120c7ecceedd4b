#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/tables/leaderboard_print.hpp"

namespace mosbench {
namespace {

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
  return [options] { return rank(*options); };
}

}  // namespace mosbench
