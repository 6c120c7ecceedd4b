#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/report/label_products.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

/// Returns a table of the paper by its name or that of its data set.
const PaperTable& table_to_run(const std::string& name) {
  for (const char* number : {"I", "II", "III"}) {
    const PaperTable& table = paper_table_named(number);
    if (name == number || name == to_string(table.dataset)) return table;
  }
  throw UsageError(
      fmt::format("table:{}: is not known, expected table:I, table:II or table:III", name));
}

/// A method of a table's rows, their protocol and ranges.
struct TableMethod {
  const MethodKind* kind;
  std::optional<std::string> protocol;  ///< nothing: that of the preset
  std::vector<double> ranges_m = {};    ///< empty: that of any preset

  /// Returns whether a row has the range of the preset.
  bool has_row_for(const Preset& preset) const {
    const double range_m = settings_of(preset, *kind).number(common_settings::kMaxRange_m);
    return ranges_m.empty() || std::ranges::find(ranges_m, range_m) != ranges_m.end();
  }
};

/// The paper's method, then every other method of mosbench that has a row in the table, and the one
/// of preset `best`.
std::vector<TableMethod> methods_of(const PaperTable& table,
                                    const std::vector<PublishedCell>& cells) {
  std::vector<TableMethod> found = {{&default_method(), std::nullopt}};
  for (const PublishedCell& cell : cells) {
    const MethodKind* kind = cell.table == table.name ? own_method(cell) : nullptr;
    if (kind == nullptr || kind == found.front().kind) continue;
    auto method = std::ranges::find(found, kind, &TableMethod::kind);
    if (method == found.end()) method = found.insert(method, {kind, cell.protocol});
    if (cell.max_range_m) method->ranges_m.push_back(*cell.max_range_m);
  }
  found.push_back({find_method(preset_named("best").method), std::nullopt});
  return found;
}

/// Says whether the recognised layout can be the wanted data set: Sipailou looks like
/// SemanticKITTI, the layout of anything without a mark of its own.
bool can_be(DatasetKind found, DatasetKind wanted, const std::filesystem::path& root) {
  return found == wanted || (found == DatasetKind::kSemanticKitti && !simulated_origin(root));
}

/// Throws DataError unless a sequence of the table is there, before hours are spent on no cell of
/// it.
void check_is_in_table(const DataWords& data, const PaperTable& table) {
  std::optional<DatasetKind> found;
  std::vector<std::string> names;
  for (const SequenceFolder& folder :
       find_sequences(data.input, {.sequences = data.sequences}, found)) {
    names.push_back(folder.name);
  }
  const auto in_table = [&](const std::string& name) { return contains(table, name); };
  if (can_be(*found, table.dataset, data.input) && std::ranges::any_of(names, in_table)) return;
  std::vector<std::string_view> wanted;
  for (const TableColumn& column : table.columns) {
    for (const std::string_view name : column.sequences) {
      if (std::ranges::find(wanted, name) == wanted.end()) wanted.push_back(name);
    }
  }
  throw DataError(
      data.input,
      fmt::format("holds data set {} with {}", to_string(*found), fmt::join(names, ", ")),
      fmt::format("{} with one or more of {} for table {}: {}", to_string(table.dataset),
                  fmt::join(wanted, ", "), table.name, table.download));
}

Job job_for(const DataWords& data, const Preset& preset, const TableMethod& method) {
  Job job;
  job.data = data_of(data);
  job.data.kind = preset.kind;
  job.segment = {.method = method.kind, .preset = &preset};
  if (method.protocol) job.rule.protocol = &protocol_named(*method.protocol);
  return job;
}

std::string folder_for(const Preset& preset, const TableMethod& method) {
  const bool is_papers = method.kind == &default_method();
  return is_papers ? std::string(preset.name)
                   : fmt::format("{}-{}", preset.name, method.kind->name);
}

/// Runs all that a table of the paper needs of the data in `words`, keeps what is finished, and
/// returns the table.
Answer run_table(const PaperTable& table, const DataWords& words, const RunPlace& place) {
  check_is_in_table(words, table);
  const std::filesystem::path out =
      place.out.value_or(fmt::format("results/runs/reproduce-{}", to_string(table.dataset)));
  const std::vector<PublishedCell> cells = built_in_cells();
  std::vector<ResultSet> runs;
  for (const TableMethod& method : methods_of(table, cells)) {
    for (const Preset& preset : presets()) {
      if (preset.kind != table.dataset || !method.has_row_for(preset)) continue;
      const RunPlace one{.out = out / folder_for(preset, method), .threads = place.threads};
      tell(fmt::format("method {}, preset {}", method.kind->name, preset.name));
      execute_run(plan_run(job_for(words, preset, method), one));
      runs.push_back(load_result_set(*one.out));
    }
  }
  for (const std::string& sentence : left_out(table, runs)) tell(sentence);
  return table_answer(fill_table(table, cells, runs));
}

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
