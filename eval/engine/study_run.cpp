#include "eval/engine/study_run.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/engine/engine_process.hpp"
#include "eval/engine/workflow_asset.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kGroup_s = 120;          // starting a job of a cluster takes seconds
constexpr std::size_t kMostInGroup = 50;  // a killed job loses at most one cell, but waits again

struct Group {
  std::vector<const PlannedCell*> cells;
  double seconds = 0, memory_mib = 0;
  bool known = true;
};

/// Cells of unknown cost stay alone.
std::vector<Group> groups_of(const StudyWork& work, const CostModel& costs, double group_s) {
  std::vector<Group> groups;
  for (const PlannedCell* planned : work.cells) {
    const auto seconds = costs.seconds(planned->cell), mib = costs.memory_mib(planned->cell);
    const bool joins = !groups.empty() && seconds && groups.back().known &&
                       groups.back().cells.size() < kMostInGroup &&
                       groups.back().seconds + *seconds <= group_s &&
                       groups.back().cells.back()->cell.data == planned->cell.data;
    if (!joins) groups.emplace_back();
    Group& group = groups.back();
    group.cells.push_back(planned);
    group.seconds += seconds.value_or(0);
    group.memory_mib = std::max(group.memory_mib, mib.value_or(0));
    group.known = group.known && seconds && mib;
  }
  return groups;
}

/// Three times the expected time and one and a half times the memory, as maps grow.
ordered_json group_json(const Group& group, std::size_t number) {
  constexpr double kUnknown_mib = 4000, kUnknownMinutes = 240;
  const double mib = group.known ? std::max(500.0, 1.5 * group.memory_mib) : kUnknown_mib;
  const double minutes = group.known ? 2 + 3 * group.seconds / 60 : kUnknownMinutes;
  ordered_json json = {{"id", fmt::format("{:05}", number)},
                       {"mem_mb", std::lround(std::ceil(mib))},
                       {"minutes", std::lround(std::ceil(minutes))},
                       {"keys", ordered_json::array()}};
  for (const PlannedCell* planned : group.cells) json["keys"].push_back(planned->cell.key);
  return json;
}

/// Where cells are computed: a program's command may name files from where it is typed. Other nodes
/// need not have that folder for anything else.
fs::path folder_of_commands(const StudyPlan& plan, const fs::path& out) {
  return std::ranges::any_of(plan.study->methods,
                             [](const StudyMethod& method) { return method.segment.is_program(); })
             ? fs::current_path()
             : out;
}

/// Writes what Snakemake reads to OUT/workflow, and returns the folder of the profile.
fs::path write_workflow(const fs::path& out, const ordered_json& plan, const std::string& profile) {
  const fs::path folder = out / "workflow";
  write_file_atomic(folder / "plan.json", json_text(plan));
  write_file_atomic(folder / "Snakefile", snakefile_asset());
  write_file_atomic(folder / "local/config.yaml", local_profile_asset());
  write_file_atomic(folder / "slurm/config.yaml", slurm_profile_asset());
  write_file_atomic(folder / "slurm_status.sh", slurm_status_asset());
  std::error_code ignored;
  fs::permissions(folder / "slurm_status.sh", fs::perms(0755), ignored);
  if (profile == "local" || profile == "slurm") return folder / profile;
  if (is_there(fs::path(profile) / "config.yaml")) return fs::absolute(profile);
  throw UsageError(fmt::format(
      "--profile: {} is no profile, expected local, slurm or a folder with config.yaml", profile));
}

}  // namespace

StudyWork work_of(const StudyPlan& plan, const CostModel& costs) {
  StudyWork work;
  double seconds = 0;
  bool known = true;
  std::set<std::string> keys;
  for (const PlannedCell& planned : plan.cells) {
    if (planned.state == CellState::kDone || !keys.insert(planned.cell.key).second) continue;
    work.cells.push_back(&planned);
    const auto expected_s = costs.seconds(planned.cell);
    known = known && expected_s.has_value();
    seconds += expected_s.value_or(0);
  }
  if (known) work.cpu_s = seconds;
  return work;
}

void run_here(const StudyPlan& plan, unsigned threads) {
  clear_study(plan.out);
  const StudyWork work = work_of(plan, {});
  keep_freed_memory();
  for (std::size_t i = 0; i < work.cells.size(); ++i) {
    tell(fmt::format("cell {} of {}: {}", i + 1, work.cells.size(), work.cells[i]->cell.title()));
    compute_cell(*work.cells[i], plan.out, threads);
  }
}

int run_engine(const StudyPlan& plan, const CostModel& costs, const EngineOptions& options) {
  const fs::path out = fs::absolute(plan.out);
  const StudyWork work = work_of(plan, costs);
  clear_study(plan.out);
  if (work.cells.empty()) return 0;
  std::set<const StudyData*> made;
  for (const PlannedCell* planned : work.cells) {
    if (made.insert(planned->cell.data).second) made_data(plan.out, planned->cell.data->data);
  }
  const bool local = options.profile == "local";
  const double even_s = work.cpu_s.value_or(0) / 64;  // so that cores end together
  const auto groups = groups_of(work, costs, local ? std::min(kGroup_s, even_s) : kGroup_s);
  ordered_json json = {{"program", options.program.string()},
                       {"folder", folder_of_commands(plan, out).string()},
                       {"study", fs::absolute(plan.study->file).string()},
                       {"out", out.string()},
                       {"threads", options.threads},
                       {"groups", ordered_json::array()}};
  for (const Group& group : groups) {
    json["groups"].push_back(group_json(group, json["groups"].size()));
  }
  const fs::path profile = write_workflow(out, json, options.profile);
  std::error_code ignored;
  fs::remove_all(out / "groups", ignored);  // of an earlier plan
  tell(fmt::format("{} in {} by Snakemake, in {}", counted(work.cells.size(), "cell"),
                   counted(groups.size(), "job"), plan.out.string()));
  const EngineEnd end = run_in_group({"snakemake", "--snakefile", out / "workflow/Snakefile",
                                      "--directory", out, "--profile", profile});
  if (end.stopped_by) {
    clear_study(plan.out);
    raise(*end.stopped_by);  // ends this process, as it would have without us
  }
  return end.exit_code;
}

}  // namespace mosbench
