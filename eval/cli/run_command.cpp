#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/report/label_products.hpp"
#include "eval/tables/table_run.hpp"

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

Answer run(RunFlags flags, const CLI::App& command) {
  const Input input = input_of(flags.words.input);
  check_flags(command, input);
  if (input == Input::kTable) {
    if (flags.data.empty()) throw UsageError("--data: is missing, expected the data of the table");
    const PaperTable& table = table_to_run(flags.words.input.string().substr(kTablePrefix.size()));
    flags.words.input = flags.data;
    return run_table(table, flags.words, flags.place);
  }
  if (input == Input::kJob) {
    flags.job.file = flags.words.input;
    flags.job.out = flags.place.out;
    check_answer_file(command, flags.job.output);
    if (command.count("--threads") > 0) flags.job.threads = flags.place.threads;
    return run_job(flags.job);
  }
  flags.place.scores = std::erase(flags.written, kScores) > 0;
  return run_data(flags.words, flags.place, flags.written);
}

/// Flags of files that name what to combine, and of tables.
void add_job_flags(CLI::App& command, RunFlags& flags) {
  JobFlags& job = flags.job;
  command
      .add_flag("--dry-run", job.dry_run,
                "Of JOB.yaml: count what is done and missing, and tell how long that takes")
      ->group(kRareGroup);
  add(command, "--on PROFILE", job.profile,
      "By Snakemake: local, slurm, or the folder of a profile (default: this process)")
      ->group(kRareGroup);
  add_list(command, "--only KEYS", job.keys, "Compute only the cells with these keys, here")
      ->group(kRareGroup);
  command.add_flag("--yes", job.yes, "Compute more than 100 cells")->group(kRareGroup);
  add(command, "-o FILE", job.output, "File of the table; - is stdout")->group(kRareGroup);
  add(command, "--data DIR", flags.data, "Of table:NAME: the folder of its data set")
      ->group(kRareGroup);
}

}  // namespace

CommandRun add_run(CLI::App& command) {
  auto flags = std::make_shared<RunFlags>();
  JobWords& words = flags->words;
  RunPlace& place = flags->place;
  add_method_flags(command, words, place.threads);
  add(command, "--protocol PROTOCOL", words.protocol, "How to score (default: by preset)");
  add(command, "--range MIN,MAX", words.range,
      "Scoring range in metres, for protocols with a limit (default: the method's)")
      ->group(kRareGroup);
  add(command, "--out DIR", place.out,
      "Folder of the results (default: results/runs/<data>-<preset>-<variant>, with "
      "--odometry also -<kind>)");
  add_odometry_flag(command, words.odometry, "Find the poses by it instead of reading them");
  std::vector<std::string> names = product_names();
  names.insert(names.begin(), kScores);
  add_list(command, "--write WHAT,...", flags->written,
           fmt::format("Also write {}; scores: of every point, and of hmm-mos-plus why it moves",
                       fmt::join(names, ", ")))
      ->check(CLI::IsMember(names));
  command.add_flag("--overwrite", place.overwrite, "Run again and replace what is in --out");
  command
      .add_flag("--verify", place.verify,
                "Read all input of finished sequences again, not only its sizes and times")
      ->group(kRareGroup);
  add_job_flags(command, *flags);
  return [flags, &command] { return run(*flags, command); };
}

}  // namespace mosbench
