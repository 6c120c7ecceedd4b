#include "eval/study/study_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/stage_clock.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/posed_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/engine/profile.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/summary_json.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"
#include "eval/study/study_scoring.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kWorstScans = 3, kMeasuredScans = 6;

RunOptions run_options(const StudyCell& cell, const Study& study, const fs::path& out,
                       unsigned threads) {
  RunOptions options = scoring_options(cell, study);
  options.input = made_data(out, *cell.data);
  options.dataset = cell.data->dataset;
  options.sequences = {cell.sequence};
  options.reading = cell.data->reading;
  options.reading.perturb = cell.perturb();
  if (!cell.odometry.empty()) options.odometry.kind = cell.odometry;
  options.threads = threads;
  return options;
}

std::int64_t wrong_points(const ScanRow& row) {
  return static_cast<std::int64_t>(row.counts->fp + row.counts->fn);
}

/// `scans` are those of a sequence that count. Scans whose map is still empty show nothing but
/// that, and are left out of longer sequences. Of scans with the same IoU, those with more wrong
/// points come first.
ordered_json worst_scans(std::vector<const ScanRow*> scans, std::span<const ScanRow> sequence) {
  constexpr std::size_t kWarmUpScans = 10;
  if (sequence.size() > 2 * kWarmUpScans) {
    std::erase_if(scans, [&](const ScanRow* row) { return row < &sequence[kWarmUpScans]; });
  }
  std::erase_if(scans, [](const ScanRow* row) { return !moving_iou(*row->counts); });
  std::ranges::stable_sort(scans, {}, [](const ScanRow* row) {
    return std::pair(moving_iou(*row->counts).value(), -wrong_points(*row));
  });
  ordered_json worst = ordered_json::array();
  for (const ScanRow* row : std::span(scans).first(std::min(scans.size(), kWorstScans))) {
    worst.push_back({{"stem", row->stem},
                     {"iou", moving_iou(*row->counts).value()},
                     {"wrong", wrong_points(*row)}});
  }
  return worst;
}

ordered_json cell_json(const StudyCell& cell) {
  return {{"data", cell.data->name},
          {"sequence", cell.sequence},
          {"method", cell.method->name},
          {"odometry", cell.odometry},
          {"axis", cell.axis == nullptr ? "" : cell.axis->name},
          {"value", cell.value},
          {"seed", cell.seed}};
}

ordered_json record_head(const StudyCell& cell) {
  return {{"key", cell.key},
          {"version", std::string(kMosbenchVersion)},
          {"cell", cell_json(cell)},
          {"identity", cell.identity}};
}

ordered_json computed_record(const StudyCell& cell, const Study& study, const fs::path& out,
                             unsigned threads) {
  const auto begin = std::chrono::steady_clock::now();
  const double begin_cpu_ms = process_cpu_ms();
  const RunPlan plan = plan_method(run_options(cell, study, out, threads));
  Sequence& sequence = *plan.dataset.sequences.front();
  if (plan.odometry) {
    set_poses(sequence, *plan.odometry, find_poses(sequence, *plan.odometry, threads));
  }
  Result result = asked_result(plan, 0);
  Result ran = run_sequence(sequence, plan.settings, std::nullopt);
  result.scans = std::move(ran.scans);
  result.timing = std::move(ran.timing);
  const std::vector<const ScanRow*> counted = counted_scans(result);
  const SequenceCounts counts = counts_of(result);

  ordered_json record = record_head(cell);
  record["simulated"] = cell.data->simulation.has_value();
  record["protocol"] = std::string(plan.settings.protocol->name);
  record["config"] = to_json(plan.settings.method_settings);
  record["fingerprint"] = ran.from.fingerprint;
  record["scans"] = result.scans.size();
  record["summary"] =
      counts.empty() ? ordered_json(nullptr) : to_json(summarize(*plan.settings.protocol, counts));
  record["worst"] = worst_scans(counted, result.scans);
  const auto seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  record["timing"] = {{"ms_per_scan", json_or_null(method_ms_per_scan(result))},
                      {"wall_s", seconds},
                      {"cpu_s", 1e-3 * (process_cpu_ms() - begin_cpu_ms)},
                      {"most_memory_mib", most_resident_mib(result).value_or(0.0)},
                      {"threads", threads},
                      {"host", host_name()},
                      {"machine", to_json(this_machine())}};
  return record;
}

CellOutcome fail(const StudyCell& cell, const fs::path& out, const char* why) {
  ordered_json record = record_head(cell);
  record["failure"] = why;
  tell(fmt::format("{}: {}", cell.title(), why));
  write_shared(failure_file(out, cell.key), json_text(record));
  return CellOutcome::kFailed;
}

/// Returns the key of a cost. It holds a hash, because names stay when a study changes.
std::string cost_name(const StudyCell& cell) {
  return fmt::format("{}/{}/{}/{}", cell.data->name, cell.sequence, cell.method->name,
                     cell.cost_key.substr(0, 12));
}

fs::path cost_file(const fs::path& out) { return out / "costs.json"; }

/// Time that a core is taken: a program of the user's is another process and may wait for a GPU.
double core_ms(const Cost& cost, const StudyMethod& method) {
  return is_program(method) ? cost.wall_ms : cost.cpu_ms;
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
  const RunPlan plan = plan_method(run_options(cell, *study.study, study.out, 1));
  Sequence& sequence = *plan.dataset.sequences.front();
  const double odometry_ms = plan.odometry ? measured_odometry_ms(sequence, *plan.odometry) : 0;
  const SequenceProfile profile = profile_sequence(sequence, plan.settings, kMeasuredScans);
  const std::size_t half = profile.scans.size() / 2;
  double first_ms = 0, later_ms = 0, memory_mib = 0;
  for (std::size_t k = 0; k < profile.scans.size(); ++k) {
    const ScanProfile& scan = profile.scans[k];
    const double ms = core_ms(scan.method, *cell.method) + core_ms(scan.read, *cell.method);
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

CellOutcome compute_cell(const PlannedCell& planned, const Study& study, const fs::path& out,
                         unsigned threads) {
  const StudyCell& cell = planned.cell;
  if (planned.state == CellState::kDone) return CellOutcome::kKept;
  if (planned.state == CellState::kOtherVersion) {
    tell(fmt::format("{}: computed by mosbench {}, again by {}", cell.title(),
                     planned.record.at("version").get<std::string>(), kMosbenchVersion));
  }
  ordered_json record;
  try {
    record = computed_record(cell, study, out, threads);
  } catch (const UsageError& error) {
    return fail(cell, out, error.what());
  } catch (const DataError& error) {
    return fail(cell, out, error.what());
  } catch (const std::bad_alloc&) {
    return fail(cell, out, "needs more memory than there is");
  }
  write_shared(record_file(out, cell.key), json_text(record));
  std::error_code ignored;
  fs::remove(failure_file(out, cell.key), ignored);
  return CellOutcome::kComputed;
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
