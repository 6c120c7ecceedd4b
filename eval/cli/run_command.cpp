#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/cli/method_options.hpp"
#include "eval/cli/odometry_flags.hpp"
#include "eval/cli/run_methods.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/report/written_products.hpp"
#include "eval/result/simulated.hpp"

namespace mosbench {
namespace {

/// Of --write, as the products that are made from labels.
constexpr const char* kScores = "scores";

struct RunFlags {
  RunOptions options;
  std::vector<std::string> written;
};

Answer run(const RunFlags& flags) {
  RunOptions options = flags.options;
  std::vector<std::string> products = flags.written;
  options.scores = std::erase(products, kScores) > 0;
  if (options.method && names_several_methods(*options.method)) {
    return run_methods(options, products);
  }
  const RunPlan plan = plan_run(options);
  const std::vector<SequenceOutcome> outcomes = execute_run(plan);
  for (const SequenceOutcome& outcome : outcomes) write_products(outcome.folder, products);
  return {.standing = standing_of(plan.dataset),
          .sheets = {run_sheet(plan, outcomes)},
          .json = json_text(run_report_json(plan, outcomes))};
}

}  // namespace

CommandRun add_run(CLI::App& command) {
  auto flags = std::make_shared<RunFlags>();
  RunOptions* options = &flags->options;
  add_method_options(command, *options);
  command.add_option("--protocol", options->protocol, "How to score (default: by preset)")
      ->type_name("PROTOCOL");
  command
      .add_option("--range", options->range,
                  "Scoring range in metres, for protocols with a limit (default: the method's)")
      ->type_name("MIN,MAX")
      ->group(kRareGroup);
  command
      .add_option("--out", options->out,
                  "Folder of the results (default: results/runs/<data>-<preset>-<variant>, with "
                  "--odometry also -<kind>)")
      ->type_name("DIR");
  add_odometry_flag(command, options->odometry, "Find the poses by it instead of reading them");
  std::vector<std::string> names = product_names();
  names.insert(names.begin(), kScores);
  command
      .add_option(
          "--write", flags->written,
          fmt::format("Also write {}; scores: of every point, and of hmm-mos-plus why it moves",
                      fmt::join(names, ", ")))
      ->type_name("WHAT,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
  command.add_flag("--overwrite", options->overwrite, "Run again and replace what is in --out");
  command
      .add_flag("--verify", options->verify,
                "Read all input of finished sequences again, not only its sizes and times")
      ->group(kRareGroup);
  return [flags] { return run(*flags); };
}

}  // namespace mosbench
