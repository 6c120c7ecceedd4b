#include "eval/engine/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <set>

#include "core/base/stage_clock.hpp"
#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/job/study_drives.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// The worst of the scans that count. Those whose map is still empty show nothing but that, and are
/// left out of longer sequences. Of scans with the same IoU, one with more wrong points is worse.
std::optional<BadScan> worst_scan(const Result& result) {
  constexpr std::size_t kWarmUpScans = 10;
  const std::size_t skipped = result.scans.size() > 2 * kWarmUpScans ? kWarmUpScans : 0;
  std::optional<BadScan> worst;
  for (const ScanRow* row : counted_scans(result)) {
    const std::optional<double> iou = moving_iou(*row->counts);
    if (row < result.scans.data() + skipped || !iou) continue;
    const auto wrong = static_cast<std::int64_t>(row->counts->fp + row->counts->fn);
    if (worst && std::pair(worst->iou, -worst->wrong) <= std::pair(*iou, -wrong)) continue;
    worst = BadScan{row->stem, *iou, wrong};
  }
  return worst;
}

/// Tells of what an earlier mosbench kept as one file per cell.
void note_old_records(const fs::path& out) {
  std::size_t records = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(out / "cells", ignored)) {
    records += entry.path().extension() == ".json" ? 1U : 0U;
  }
  if (records == 0) return;
  tell(fmt::format("{}: {} of an earlier mosbench, not used: cells have folders now; remove them",
                   (out / "cells").string(), counted(records, "record is", "records are")));
}

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

/// Looks again at what lies where a cell's result belongs. A file that is damaged, or of another
/// cell, is none.
void look_up(PlannedCell& planned, const fs::path& out, bool may_have_changed = false) {
  const std::string& key = planned.cell.key;
  const fs::path result = cell_folder(out, key) / "result.json";
  const fs::path failure = cell_folder(out, key) / "failure.json";
  planned.state = CellState::kMissing;
  planned.numbers = {};
  planned.failure.clear();
  try {
    const Result found = is_there(result) ? read_result(result) : Result{};
    // The same content may have been run from other files, which have changed since.
    if (found.key == key && (may_have_changed || !changed_program_file(found))) {
      planned.numbers = numbers_of(found);
      const bool is_own = found.from.version == kMosbenchVersion;
      planned.state = is_own ? CellState::kDone : CellState::kOtherVersion;
      return;
    }
  } catch (const DataError&) {
  }
  try {
    const ordered_json found =
        is_there(failure) ? parse_json(read_file(failure), failure) : nullptr;
    if (found.is_null() || found.at("key") != key) return;
    planned.failure = found.at("failure").get<std::string>();
    planned.state = CellState::kFailed;
  } catch (const DataError&) {
  } catch (const ordered_json::exception&) {
  }
}

void look_up_all(StudyPlan& plan, bool may_have_changed) {
  ThreadPool pool(hardware_threads());
  pool.for_ranges(plan.cells.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) look_up(plan.cells[i], plan.out, may_have_changed);
  });
}

}  // namespace

CellNumbers numbers_of(const Result& result) {
  CellNumbers numbers;
  numbers.version = result.from.version;
  numbers.simulated = result.is_simulated();
  numbers.simulation = drive_of(result.from.simulated);
  numbers.fingerprint = result.from.fingerprint_without_poses;
  numbers.doubts = doubts_of(result);
  numbers.counts = counts_of(result);
  numbers.gaps = gaps_of(result);
  if (!numbers.counts.empty()) {
    const Summary summary = summarize(*result.protocol, numbers.counts);
    for (std::size_t i = 0; i < kBriefMetrics.size(); ++i) {
      numbers.metrics[i] = summary[kBriefMetrics[i]];
    }
  }
  numbers.ms_per_scan = method_ms_per_scan(result);
  if (result.timing) {
    numbers.wall_s = result.timing->wall_s;
    numbers.core_s = result.timing->core_s;
  }
  numbers.worst = worst_scan(result);
  return numbers;
}

StudyPlan plan_study(const Study& study, const fs::path& out, const std::vector<std::string>& only,
                     const std::vector<ProgramFile>* known) {
  StudyPlan plan{&study, out, {}, std::nullopt};
  std::vector<StudyCell> cells = cells_of(study, known);
  plan.rule = shared_rule(study, cells);
  for (StudyCell& cell : cells) {
    const bool wanted = only.empty() || std::ranges::find(only, cell.key) != only.end();
    if (wanted) plan.cells.push_back({.cell = std::move(cell)});
  }
  if (!is_there(out / "cells")) return plan;
  note_old_records(out);
  look_up_all(plan, false);
  return plan;
}

std::vector<ProgramFile> recorded_program_files(const Study& study, const fs::path& out) {
  std::vector<ProgramFile> files;
  const auto is_program = [](const StudyMethod& method) { return method.segment.is_program(); };
  if (std::ranges::none_of(study.methods, is_program)) return files;
  std::error_code ignored;
  for (const auto& cell : fs::directory_iterator(out / "cells", ignored)) {
    try {
      const Result result = read_result(cell.path() / "result.json");
      files.insert(files.end(), result.from.program_files.begin(), result.from.program_files.end());
    } catch (const DataError&) {  // a cell that failed
    }
  }
  return files;
}

void refresh(StudyPlan& plan) {
  const std::vector<ProgramFile> none;  // so that a file that is gone has changed
  look_up_all(plan, true);
  for (const StudyMethod& method : plan.study->methods) {
    const std::string now = hash_of_program(files_of_program(*method.segment.method, &none));
    const auto is_stale = [&](const PlannedCell& planned) {
      return planned.cell.method == &method && planned.cell.program != now;
    };
    if (std::ranges::none_of(plan.cells, is_stale)) continue;
    tell(
        fmt::format("{}: a file that its command names has changed during the run, expected files "
                    "that stay as they are: the next run computes its cells again",
                    method.name));
  }
}

std::string_view to_string(CellState state) {
  static constexpr std::array<std::string_view, 4> kStates = {"missing", "failed", "other version",
                                                              "done"};
  return kStates[static_cast<std::size_t>(state)];
}

fs::path cell_folder(const fs::path& out, const std::string& key) { return out / "cells" / key; }

fs::path place_of(const fs::path& out, const Data& data) {
  return data.simulation ? out / "data" / simulation_key(*data.simulation) : data.path;
}

void clear_study(const fs::path& out) {
  for (const fs::path& folder : {out, out / "cells", out / "data"}) remove_abandoned(folder);
}

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
  try {
    put(*std::move(result));
  } catch (const DataError& full) {
    const fs::path file = cell_folder(out, cell.key) / "result.json";
    throw DataError(fmt::format("{}, as {}", file.string(), full.what()));
  }
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

std::string default_title(const StudyPlan& plan) {
  std::set<std::string> presets;
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    if (cell.axis == nullptr) presets.insert(std::string(preset_of(cell.job, cell.kind).name));
  }
  return fmt::format("default of preset{} {}", presets.size() == 1 ? "" : "s",
                     fmt::join(presets, ", "));
}

}  // namespace mosbench
