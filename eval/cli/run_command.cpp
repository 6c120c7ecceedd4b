#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/cli/method_options.hpp"
#include "eval/cli/odometry_flags.hpp"
#include "eval/cli/run_job.hpp"
#include "eval/cli/run_methods.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/cli/run_table.hpp"
#include "eval/cli/suggested_command.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/job_words.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/report/written_products.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {
namespace {

/// Of --write, as the products that are made from labels.
constexpr const char* kScores = "scores";

struct RunFlags {
  JobWords words;
  RunPlace place;
  std::vector<std::string> written;
  JobFlags job;
  std::filesystem::path data;  ///< of a table
};

constexpr std::string_view kTablePrefix = "table:";

enum class Input { kData, kJob, kTable };

Input input_of(const std::filesystem::path& input) {
  if (input.string().starts_with(kTablePrefix)) return Input::kTable;
  return is_job(input) ? Input::kJob : Input::kData;
}

/// Throws UsageError where a flag was given that a run of this input does not heed.
void check_flags(const CLI::App& command, Input input) {
  constexpr std::array kOfAnyInput = {"--out", "--threads", "--as", "--json"};
  constexpr std::array kOfJob = {"--dry-run", "--on", "--only", "--yes", "-o"};
  const auto has = [](const auto& list, const std::string& name) {
    return std::ranges::find(list, name) != list.end();
  };
  const std::string given = given_words(command, [&](const CLI::Option& option) {
    const std::string name = option.get_name();
    if (!option.nonpositional() || has(kOfAnyInput, name)) return false;
    if (has(kOfJob, name)) return input != Input::kJob;
    if (name == "--data") return input != Input::kTable;
    return input == Input::kJob || (input == Input::kTable && name != "--sequences");
  });
  if (given.empty()) return;
  constexpr std::array kNames = {"a run of data", "JOB.yaml", "table:NAME"};
  throw UsageError(fmt::format("{}: is nothing for {}, expected it left out", given.substr(1),
                               kNames[static_cast<std::size_t>(input)]));
}

Answer run_other(RunFlags flags, Input input, bool threads_given) {
  const JobWords& words = flags.words;
  const RunPlace& place = flags.place;
  if (input == Input::kTable) {
    if (flags.data.empty()) throw UsageError("--data: is missing, expected the data of the table");
    return run_table({.name = words.input.string().substr(kTablePrefix.size()),
                      .root = flags.data,
                      .out = place.out,
                      .sequences = words.sequences,
                      .threads = place.threads});
  }
  flags.job.file = words.input;
  flags.job.out = place.out;
  if (threads_given) flags.job.threads = place.threads;
  return run_job(flags.job);
}

Answer run(const RunFlags& flags, const CLI::App& command) {
  const Input input = input_of(flags.words.input);
  check_flags(command, input);
  if (input != Input::kData) return run_other(flags, input, command.count("--threads") > 0);
  const JobWords& words = flags.words;
  RunPlace place = flags.place;
  std::vector<std::string> products = flags.written;
  place.scores = std::erase(products, kScores) > 0;
  if (words.method && names_several_methods(*words.method)) {
    return run_methods(words, place, products);
  }
  const RunPlan plan = plan_run(job_of(words), place);
  const std::vector<SequenceOutcome> outcomes = execute_run(plan);
  for (const SequenceOutcome& outcome : outcomes) write_products(outcome.folder, products);
  return {.standing = standing_of(plan.dataset),
          .sheets = {run_sheet(plan, outcomes)},
          .json = json_text(run_report_json(plan, outcomes))};
}

/// Flags of files that name what to combine, and of tables.
void add_job_flags(CLI::App& command, RunFlags& flags) {
  JobFlags& job = flags.job;
  command
      .add_flag("--dry-run", job.dry_run,
                "Of JOB.yaml: count what is done and missing, and tell how long that takes")
      ->group(kRareGroup);
  command
      .add_option("--on", job.profile,
                  "By Snakemake: local, slurm, or the folder of a profile (default: this process)")
      ->type_name("PROFILE")
      ->group(kRareGroup);
  command.add_option("--only", job.keys, "Compute only the cells with these keys, here")
      ->type_name("KEYS")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group(kRareGroup);
  command.add_flag("--yes", job.yes, "Compute more than 100 cells")->group(kRareGroup);
  command.add_option("-o", job.output, "File of the table; - is stdout")
      ->type_name("FILE")
      ->group(kRareGroup);
  command.add_option("--data", flags.data, "Of table:NAME: the folder of its data set")
      ->type_name("DIR")
      ->group(kRareGroup);
}

}  // namespace

CommandRun add_run(CLI::App& command) {
  auto flags = std::make_shared<RunFlags>();
  JobWords* words = &flags->words;
  RunPlace* place = &flags->place;
  add_method_options(command, *words, place->threads);
  command.add_option("--protocol", words->protocol, "How to score (default: by preset)")
      ->type_name("PROTOCOL");
  command
      .add_option("--range", words->range,
                  "Scoring range in metres, for protocols with a limit (default: the method's)")
      ->type_name("MIN,MAX")
      ->group(kRareGroup);
  command
      .add_option("--out", place->out,
                  "Folder of the results (default: results/runs/<data>-<preset>-<variant>, with "
                  "--odometry also -<kind>)")
      ->type_name("DIR");
  add_odometry_flag(command, words->odometry, "Find the poses by it instead of reading them");
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
  command.add_flag("--overwrite", place->overwrite, "Run again and replace what is in --out");
  command
      .add_flag("--verify", place->verify,
                "Read all input of finished sequences again, not only its sizes and times")
      ->group(kRareGroup);
  add_job_flags(command, *flags);
  return [flags, &command] { return run(*flags, command); };
}

}  // namespace mosbench
