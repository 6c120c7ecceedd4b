#include "eval/engine/study_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "core/base/stage_clock.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/posed_sequence.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/engine/profile.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kMeasuredScans = 6;

Job job_of(const StudyCell& cell, const fs::path& out) {
  Job job = cell.job;
  job.data.path = made_data(out, job.data);
  return job;
}

ComputedSequence computed(const StudyCell& cell, const fs::path& out, unsigned threads) {
  RunPlan plan = open_job(job_of(cell, out), threads);
  plan.settings.keeps_labels = false;
  const Sequence& sequence = *plan.dataset.sequences.front();
  plan.sequences.push_back({.position = 0,
                            .folder = ResultFolder(cell_folder(out, cell.key), Writers::kMany),
                            .asked = asked_result(plan, 0),
                            .stamp = file_stamp(sequence)});
  plan.sequences.front().asked.key = cell.key;
  return compute_sequence(plan, plan.sequences.front());
}

void put_cell(ComputedSequence result, const fs::path& folder) {
  try {
    put(std::move(result));
  } catch (const DataError& full) {
    throw DataError(fmt::format("{}, as {}", (folder / "result.json").string(), full.what()));
  }
}

CellOutcome fail(const StudyCell& cell, const fs::path& out, const char* why) {
  tell(fmt::format("{}: {}", cell.title(), why));
  Claim claim(cell_folder(out, cell.key));
  commit_file(claim.path() / "failure.json",
              json_text({{"key", cell.key}, {"cell", cell.title()}, {"failure", why}}));
  claim.put();
  return CellOutcome::kFailed;
}

/// Returns a number of a cost; nothing where it was not measured.
std::optional<double> number_in(const ordered_json& costs, const std::string& name,
                                const char* what) {
  const auto found = costs.find(name);
  if (found == costs.end() || !found->is_object()) return std::nullopt;
  const auto value = found->find(what);
  if (value == found->end() || !value->is_number()) return std::nullopt;
  return value->get<double>();
}

/// Where costs of a method on a sequence are kept: by what they are, as a name stays when a study
/// is edited.
std::string cost_name(const StudyCell& cell) {
  return fmt::format("{}/{}/{}/{}", cell.data->name, cell.sequence, cell.method->name,
                     cell.cost_key.substr(0, 12));
}

fs::path cost_file(const fs::path& out) { return out / "costs.json"; }

/// Time that a core is taken: a program of the user's is another process and may wait for a GPU.
double core_ms(const Cost& cost, const Segment& segment) {
  return segment.is_program() ? cost.wall_ms : cost.cpu_ms;
}

/// Finds poses of the first scans, and leaves the sensor standing after them. Returns the CPU time
/// of a scan.
double measured_odometry_ms(Sequence& sequence, const OdometryChoice& odometry) {
  const auto& posed = dynamic_cast<const PosedSequence&>(sequence);
  const double begin_cpu_ms = process_cpu_ms();
  auto poses = estimate_poses(posed.unposed(), odometry, 1, kMeasuredScans);
  const double cpu_ms = process_cpu_ms() - begin_cpu_ms;
  if (poses.empty()) return 0;
  const double scans = static_cast<double>(poses.size());
  poses.resize(sequence.size(), poses.back());
  set_poses(sequence, odometry, poses);
  return cpu_ms / scans;
}

/// The first scans, when the map is still filling, cost less than the others; the last of them
/// stand for those. What the first ones cost more is the start of a program.
ordered_json measured_cost(const StudyPlan& study, const StudyCell& cell) {
  constexpr double kStart_s = 0.1;
  const RunPlan plan = open_job(job_of(cell, study.out), 1);
  Sequence& sequence = *plan.dataset.sequences.front();
  const double odometry_ms = plan.odometry ? measured_odometry_ms(sequence, *plan.odometry) : 0;
  const SequenceProfile profile = profile_sequence(sequence, plan.settings, kMeasuredScans);
  const std::size_t half = profile.scans.size() / 2;
  double first_ms = 0, later_ms = 0, memory_mib = 0;
  for (std::size_t k = 0; k < profile.scans.size(); ++k) {
    const ScanProfile& scan = profile.scans[k];
    const double ms = core_ms(scan.method, cell.job.segment) + core_ms(scan.read, cell.job.segment);
    (k < half ? first_ms : later_ms) += ms;
    memory_mib = std::max(memory_mib, scan.resident_mib);
  }
  memory_mib += profile.program_mib;
  const double later_scans = static_cast<double>(profile.scans.size() - half);
  const double ms_per_scan = later_ms / later_scans;
  const double start_ms = first_ms - ms_per_scan * static_cast<double>(half);
  return {{"start_s", std::max(kStart_s, 1e-3 * start_ms)},
          {"ms_per_scan", ms_per_scan + odometry_ms},
          {"scans", sequence.size()},
          {"memory_mib", memory_mib}};
}

}  // namespace

CellOutcome compute_cell(const PlannedCell& before, const fs::path& out, unsigned threads) {
  PlannedCell planned = before;
  look_up(planned, out);  // another cell may ask the same, another process may have been here
  const StudyCell& cell = planned.cell;
  if (planned.state == CellState::kDone) return CellOutcome::kKept;
  if (planned.state == CellState::kOtherVersion) {
    tell(fmt::format("{}: computed by mosbench {}, again by {}", cell.title(),
                     planned.numbers.version, kMosbenchVersion));
  }
  std::optional<ComputedSequence> result;
  try {
    result = computed(cell, out, threads);
  } catch (const UsageError& error) {
    return fail(cell, out, error.what());
  } catch (const DataError& error) {
    return fail(cell, out, error.what());
  } catch (const std::bad_alloc&) {
    return fail(cell, out, "needs more memory than there is");
  }
  put_cell(*std::move(result), cell_folder(out, cell.key));
  return CellOutcome::kComputed;
}

fs::path made_data(const fs::path& out, const Data& data) {
  const fs::path folder = place_of(out, data);
  if (!data.simulation || is_there(folder)) return folder;
  Claim claim(folder);
  simulate({.layout = data.simulation->layout,
            .scene = data.simulation->scene,
            .scans = data.simulation->scans,
            .seed = data.simulation->seed,
            .out = claim.path()});
  claim.put_unless_there();  // the data of another process are the same
  return folder;
}

CostModel read_costs(const fs::path& out) {
  CostModel model;
  if (!is_there(cost_file(out))) return model;
  const ordered_json costs = parse_json(read_file(cost_file(out)), cost_file(out));
  if (costs.is_object()) model.costs = costs;
  return model;
}

void measure_costs(const StudyPlan& plan) {
  CostModel model = read_costs(plan.out);
  bool changed = false;
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    if (cell.axis != nullptr || model.costs.contains(cost_name(cell))) continue;
    try {
      model.costs[cost_name(cell)] = measured_cost(plan, cell);
      changed = true;
    } catch (const std::runtime_error& error) {  // fails again as a cell
      tell(fmt::format("{}: not measured: {}", cell.title(), error.what()));
    }
  }
  if (changed) write_shared(cost_file(plan.out), json_text(model.costs));
}

std::optional<double> CostModel::seconds(const StudyCell& cell) const {
  const std::string name = cost_name(cell);
  const auto start_s = number_in(costs, name, "start_s");
  const auto ms = number_in(costs, name, "ms_per_scan"), scans = number_in(costs, name, "scans");
  if (!start_s || !ms || !scans) return std::nullopt;
  return *start_s + 1e-3 * *ms * *scans;
}

std::optional<double> CostModel::memory_mib(const StudyCell& cell) const {
  return number_in(costs, cost_name(cell), "memory_mib");
}

}  // namespace mosbench
