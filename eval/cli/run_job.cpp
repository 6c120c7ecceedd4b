#include <fmt/format.h>

#include <algorithm>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/engine/study_plan.hpp"
#include "eval/engine/study_run.hpp"
#include "eval/result/tell.hpp"
#include "eval/study/study_table.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostWithoutYes = 100;

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
  if (!work.cpu_s) return "how long it takes is not known";
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

Answer plan_answer(const StudyPlan& plan) {
  measure_costs(plan);
  const CostModel costs = read_costs(plan.out);
  return {.text = fmt::format("{}\n{}\nresults in {}\n", state_counts(plan),
                              work_text(work_of(plan, costs)), plan.out.string()),
          .json = json_text(plan_json(plan, costs))};
}

Answer cell_answer(const StudyPlan& plan, const JobFlags& flags) {
  std::string text;
  bool failed = false;
  for (const std::string& key : flags.keys) {
    const auto found =
        std::ranges::find(plan.cells, key, [](const PlannedCell& one) { return one.cell.key; });
    if (found == plan.cells.end()) {
      throw UsageError(fmt::format(
          "{0}: has no cell {1}, expected one that `mosbench run {0} --dry-run --json` lists",
          flags.file.string(), key));
    }
    const CellOutcome outcome = compute_cell(*found, plan.out, std::max(1U, flags.threads));
    failed = failed || outcome == CellOutcome::kFailed;
    static constexpr std::array kOutcomes = {"computed", "kept", "failed"};
    text += fmt::format("{} {}: {}\n", key, kOutcomes[static_cast<std::size_t>(outcome)],
                        found->cell.title());
  }
  return {text, failed ? 1 : 0};
}

Answer table_answer(const StudyPlan& plan, const StudyTable& table, const JobFlags& flags) {
  Answer answer = study_answer(plan, table);
  answer.file = flags.output;
  return answer;
}

void run_by_snakemake(const StudyPlan& plan, const CostModel& costs, const JobFlags& flags) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const int engine = run_engine(plan, costs,
                                {.profile = *flags.profile,
                                 .threads = std::max(1U, flags.threads),
                                 .program = error ? std::filesystem::path("mosbench") : program});
  if (engine != 0) tell(fmt::format("Snakemake ended with exit code {}", engine));
}

Answer run_answer(const StudyPlan& plan, const JobFlags& flags) {
  check_presets(plan);
  const std::size_t pending = work_of(plan, {}).cells.size();
  if (pending > 0 && (flags.profile || pending > kMostWithoutYes)) measure_costs(plan);
  const CostModel costs = read_costs(plan.out);
  const std::string work = work_text(work_of(plan, costs));
  tell(state_counts(plan));
  tell(work);
  if (pending > kMostWithoutYes && !flags.yes) {
    throw UsageError(fmt::format("{}: {} cells are to be computed, and {}, expected --yes",
                                 flags.file.string(), pending, work));
  }
  if (flags.profile) {
    run_by_snakemake(plan, costs, flags);
  } else {
    run_here(plan, flags.threads > 0 ? flags.threads : hardware_threads());
  }
  StudyPlan computed = plan;
  refresh(computed);
  const StudyTable table = gather(computed);
  write_presets(table.choices);
  return table_answer(computed, table, flags);
}

std::filesystem::path out_of(const JobFlags& flags) {
  return flags.out.value_or(std::filesystem::path("results/runs") / flags.file.stem());
}

}  // namespace

bool is_job(const std::filesystem::path& input) {
  const std::filesystem::path ending = input.extension();
  return (ending == ".yaml" || ending == ".yml") && input.filename() != "metadata.yaml";
}

Answer run_job(const JobFlags& flags) {
  const Study study = read_study(flags.file);
  const StudyPlan plan = plan_study(study, out_of(flags), flags.keys);
  if (flags.dry_run) return plan_answer(plan);
  return flags.keys.empty() ? run_answer(plan, flags) : cell_answer(plan, flags);
}

Answer rank_job(const JobFlags& flags) {
  const Study study = read_study(flags.file);
  const std::vector<ProgramFile> known = recorded_program_files(study, out_of(flags));
  const StudyPlan plan = plan_study(study, out_of(flags), flags.keys, &known);
  return table_answer(plan, gather(plan), flags);
}

}  // namespace mosbench
