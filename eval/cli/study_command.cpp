#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/result/progress.hpp"
#include "eval/result/tell.hpp"
#include "eval/study/study_cell.hpp"
#include "eval/study/study_run.hpp"
#include "eval/study/study_table.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostWithoutYes = 100;

struct StudyFlags {
  std::string action;
  std::filesystem::path file;
  std::vector<std::string> keys;
  std::optional<std::filesystem::path> out;
  std::filesystem::path output = "-";
  std::string profile = "local";
  unsigned threads = 1;
  bool measure = false, yes = false;
};

std::string state_counts(const StudyPlan& plan) {
  std::size_t done = 0, failed = 0, other = 0;
  for (const PlannedCell& planned : plan.cells) {
    done += planned.state == CellState::kDone;
    failed += planned.state == CellState::kFailed;
    other += planned.state == CellState::kOtherVersion;
  }
  const std::size_t missing = plan.cells.size() - done - failed - other;
  return fmt::format("{}: {} done, {} missing, {} failed, {} of another version of mosbench",
                     counted(plan.cells.size(), "cell"), done, missing, failed, other);
}

std::string work_text(const StudyWork& work) {
  if (work.cells.empty()) return "nothing is to be computed";
  if (!work.cpu_s) return "how long it takes is not known, --measure tells";
  return fmt::format("{} of one core are to be computed", duration_text(*work.cpu_s));
}

nlohmann::ordered_json plan_json(const StudyPlan& plan, const CostModel& costs) {
  nlohmann::ordered_json json = {{"study", plan.study->name},
                                 {"out", plan.out.string()},
                                 {"cpu_s", json_or_null(work_of(plan, costs).cpu_s)},
                                 {"cells", nlohmann::ordered_json::array()}};
  for (const PlannedCell& planned : plan.cells) {
    json["cells"].push_back({{"key", planned.cell.key},
                             {"title", planned.cell.title()},
                             {"state", to_string(planned.state)},
                             {"seconds", json_or_null(costs.seconds(planned.cell))}});
  }
  return json;
}

Answer plan_answer(const StudyPlan& plan, const StudyFlags& flags) {
  if (flags.measure) measure_costs(plan);
  const CostModel costs = read_costs(plan.out);
  return {.text = fmt::format("{}\n{}\nresults in {}\n", state_counts(plan),
                              work_text(work_of(plan, costs)), plan.out.string()),
          .json = json_text(plan_json(plan, costs))};
}

Answer cell_answer(const StudyPlan& plan, const StudyFlags& flags) {
  if (flags.keys.empty()) throw UsageError("study cell: names no cell, expected its KEY");
  std::string text;
  bool failed = false;
  for (const std::string& key : flags.keys) {
    const auto found = std::ranges::find_if(
        plan.cells, [&](const PlannedCell& planned) { return planned.cell.key == key; });
    if (found == plan.cells.end()) {
      throw UsageError(
          fmt::format("{}: has no cell {}, expected one that `mosbench study plan "
                      "{} --json` lists",
                      flags.file.string(), key, flags.file.string()));
    }
    const CellOutcome outcome = compute_cell(*found, *plan.study, plan.out, flags.threads);
    failed = failed || outcome == CellOutcome::kFailed;
    static constexpr std::array kOutcomes = {"computed", "kept", "failed"};
    text += fmt::format("{} {}: {}\n", key, kOutcomes[static_cast<std::size_t>(outcome)],
                        found->cell.title());
  }
  return {text, failed ? 1 : 0};
}

Answer table_answer(const StudyPlan& plan, const StudyFlags& flags) {
  Answer answer = study_answer(plan, gather(plan));
  answer.file = flags.output;
  return answer;
}

Answer run_answer(const Study& study, const StudyPlan& plan, const StudyFlags& flags) {
  const std::size_t pending = work_of(plan, {}).cells.size();
  if (pending > 0) measure_costs(plan);
  const CostModel costs = read_costs(plan.out);
  tell(state_counts(plan));
  tell(work_text(work_of(plan, costs)));
  if (pending > kMostWithoutYes && !flags.yes) {
    throw UsageError(fmt::format("study run: {} cells are to be computed, and {}, expected --yes",
                                 pending, work_text(work_of(plan, costs))));
  }
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const int engine = run_engine(plan, costs,
                                {.profile = flags.profile,
                                 .threads = flags.threads,
                                 .program = error ? std::filesystem::path("mosbench") : program});
  if (engine != 0) tell(fmt::format("Snakemake ended with exit code {}", engine));
  return table_answer(plan_study(study, plan.out), flags);
}

Answer study(const StudyFlags& flags) {
  check_output(flags.output);
  const Study study = read_study(flags.file);
  const std::filesystem::path out =
      flags.out.value_or(std::filesystem::path("results/runs") / flags.file.stem());
  const StudyPlan plan =
      plan_study(study, out, flags.action == "cell" ? flags.keys : std::vector<std::string>());
  if (flags.action == "plan") return plan_answer(plan, flags);
  if (flags.action == "cell") return cell_answer(plan, flags);
  if (flags.action == "run") return run_answer(study, plan, flags);
  return table_answer(plan, flags);
}

}  // namespace

CommandRun add_study(CLI::App& command) {
  auto flags = std::make_shared<StudyFlags>();
  command.add_option("ACTION", flags->action, "plan, run, cell or table")
      ->required()
      ->check(CLI::IsMember({"plan", "run", "cell", "table"}));
  command.add_option("FILE", flags->file, "The study, a YAML file")->type_name("FILE")->required();
  command.add_option("KEY", flags->keys, "Of cells to compute");
  command
      .add_option("--out", flags->out,
                  "Folder of the results (default: results/runs/<name of FILE>)")
      ->type_name("DIR");
  command
      .add_option("--profile", flags->profile, "local, slurm, or the folder of a Snakemake profile")
      ->type_name("PROFILE")
      ->capture_default_str();
  command.add_option("-o,--output", flags->output, "File of the table; - is stdout")
      ->type_name("FILE")
      ->capture_default_str();
  add_threads_flag(command, flags->threads);
  command.get_option("--threads")->description("Threads of each cell; results do not depend on it");
  command.add_flag("--measure", flags->measure, "With plan: measure what a scan costs first");
  command.add_flag("--yes", flags->yes, "With run: compute more than 100 cells");
  return [flags] { return study(*flags); };
}

}  // namespace mosbench
