#include "eval/study/study_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/stage_clock.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/json_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/summary_json.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/machine.hpp"
#include "eval/results/settings_json.hpp"
#include "eval/results/tell.hpp"
#include "eval/results/version.hpp"
#include "eval/runs/profile.hpp"
#include "eval/runs/run_execute.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kWorstScans = 3, kMeasuredScans = 6;

RunOptions run_options(const StudyCell& cell, const Study& study, const fs::path& out,
                       unsigned threads) {
  RunOptions options;
  options.input = made_data(out, *cell.data);
  options.dataset = cell.data->dataset;
  options.sequences = {cell.sequence};
  options.method = cell.method->method;
  options.preset = cell.method->preset;
  options.protocol = study.protocol;
  options.range = study.range;
  options.reading = cell.data->reading;
  options.reading.perturb = cell.perturb();
  if (!cell.odometry.empty()) options.odometry.kind = cell.odometry;
  options.assignments = cell.assignments;
  options.threads = threads;
  return options;
}

ordered_json worst_scans(std::vector<const ScanRow*> scans) {
  std::erase_if(scans, [](const ScanRow* row) { return !moving_iou(*row->counts); });
  std::ranges::stable_sort(scans, {},
                           [](const ScanRow* row) { return moving_iou(*row->counts).value(); });
  ordered_json worst = ordered_json::array();
  for (const ScanRow* row : std::span(scans).first(std::min(scans.size(), kWorstScans))) {
    worst.push_back({{"stem", row->stem}, {"iou", moving_iou(*row->counts).value()}});
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
  const SequenceRows rows = run_sequence(sequence, plan.settings, std::nullopt);
  const std::vector<const ScanRow*> counted = counted_scans(plan, 0, rows);
  std::vector<Confusion> counts;
  for (const ScanRow* row : counted) counts.push_back(*row->counts);
  double memory_mib = 0;
  for (const ScanCost& cost : rows.costs) memory_mib = std::max(memory_mib, cost.resident_mib);

  ordered_json record = record_head(cell);
  record["simulated"] = cell.data->simulation.has_value();
  record["protocol"] = std::string(plan.settings.protocol->name);
  record["config"] = to_json(plan.settings.method_settings);
  record["fingerprint"] = rows.fingerprint;
  record["scans"] = rows.scans.size();
  record["summary"] =
      counts.empty() ? ordered_json(nullptr) : to_json(summarize(*plan.settings.protocol, counts));
  record["worst"] = worst_scans(counted);
  const auto seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  record["timing"] = {{"ms_per_scan", json_or_null(method_ms_per_scan(rows))},
                      {"wall_s", seconds},
                      {"cpu_s", 1e-3 * (process_cpu_ms() - begin_cpu_ms)},
                      {"most_memory_mib", memory_mib},
                      {"threads", threads},
                      {"host", host_name()},
                      {"machine", machine_json()}};
  return record;
}

CellOutcome fail(const StudyCell& cell, const fs::path& out, const char* why) {
  ordered_json record = record_head(cell);
  record["failure"] = why;
  tell(fmt::format("{}: {}", cell.title(), why));
  write_shared(failure_file(out, cell.key), json_text(record));
  return CellOutcome::kFailed;
}

/// Where costs of a method on a sequence are kept: by what they are, as a name stays when a study
/// is edited.
std::string cost_name(const StudyCell& cell) {
  return fmt::format("{}/{}/{}/{}", cell.data->name, cell.sequence, cell.method->name,
                     cell.cost_key.substr(0, 12));
}

fs::path cost_file(const fs::path& out) { return out / "costs.json"; }

/// The first scans, when the map is still filling, cost less than the others; the last of them
/// stand for those.
ordered_json measured_cost(const StudyPlan& study, const StudyCell& cell) {
  const RunPlan plan = plan_method(run_options(cell, *study.study, study.out, 1));
  const Sequence& sequence = *plan.dataset.sequences.front();
  const SequenceProfile profile = profile_sequence(sequence, plan.settings, kMeasuredScans);
  const std::size_t half = profile.scans.size() / 2;
  double cpu_ms = 0, memory_mib = 0;
  for (std::size_t k = half; k < profile.scans.size(); ++k) {
    cpu_ms += profile.scans[k].method.cpu_ms + profile.scans[k].read.cpu_ms;
    memory_mib = std::max(memory_mib, profile.scans[k].resident_mib);
  }
  return {{"ms_per_scan", cpu_ms / static_cast<double>(profile.scans.size() - half)},
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
  constexpr double kStart_s = 0.1;
  const std::string name = cost_name(cell);
  const auto ms = number_in(costs, name, "ms_per_scan"), scans = number_in(costs, name, "scans");
  if (!ms || !scans) return std::nullopt;
  return kStart_s + 1e-3 * *ms * *scans;
}

std::optional<double> CostModel::memory_mib(const StudyCell& cell) const {
  return number_in(costs, cost_name(cell), "memory_mib");
}

}  // namespace mosbench
