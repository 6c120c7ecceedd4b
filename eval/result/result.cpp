#include "eval/result/result.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/formats/label_file.hpp"

namespace mosbench {

bool are_labels_of(const ScanRow& row, std::span<const std::uint32_t> labels) {
  if (row.label_hash) return hash_of_labels(labels) == row.label_hash;
  const auto moving = static_cast<std::size_t>(std::ranges::count(labels, kMovingLabel));
  return moving == row.predicted_moving_points;
}

void add_stages(const std::vector<StageTime>& stages, Timing& timing, ScanCost& cost) {
  for (const StageTime& stage : stages) {
    const auto found = std::ranges::find(timing.stages, stage.name);
    const auto position = static_cast<std::size_t>(found - timing.stages.begin());
    if (found == timing.stages.end()) timing.stages.emplace_back(stage.name);
    if (cost.stages_ms.size() <= position) cost.stages_ms.resize(position + 1);
    cost.stages_ms[position] += stage.wall_ms;
  }
}

std::optional<double> method_ms_per_scan(const Result& result) {
  if (!result.timing || result.timing->costs.empty()) return std::nullopt;
  double sum_ms = 0.0;
  for (const ScanCost& cost : result.timing->costs) sum_ms += cost.push_ms;
  return sum_ms / static_cast<double>(result.timing->costs.size());
}

std::optional<double> most_resident_mib(const Result& result) {
  std::optional<double> most;
  if (!result.timing) return most;
  for (const ScanCost& cost : result.timing->costs) {
    most = std::max(most, std::optional(cost.resident_mib));
  }
  return most;
}

std::optional<std::string> only_split(const Result& result) {
  const bool is_own = result.summary_split == std::string(result.protocol->default_split);
  return is_own ? std::nullopt : result.summary_split;
}

std::string disturbance_of(const Result& result) {
  const auto perturb =
      std::ranges::find(result.from.reading, "perturb", &ReadingMembers::value_type::first);
  return perturb == result.from.reading.end() ? "" : perturb->second;
}

std::string simulation_of(const Result& result) {
  const std::optional<SimulatedOrigin>& origin = result.from.simulated;
  return origin ? fmt::format("{} {} {}", origin->scene, origin->seed, origin->perturb.value_or(""))
                : "";
}

std::vector<const ScanRow*> counted_scans(const Result& result) {
  const std::string own_split(result.protocol->default_split);
  const auto split = result.splits.find(own_split);
  std::vector<const ScanRow*> scans;
  // Of a sequence outside of the split nothing counts.
  if (split == result.splits.end() && result.summary_split == own_split) return scans;
  for (const ScanRow& row : result.scans) {
    if (!row.counts) continue;
    if (split == result.splits.end() || split->second.contains(row.stem)) scans.push_back(&row);
  }
  return scans;
}

SequenceCounts counts_of(const Result& result) {
  SequenceCounts counts;
  for (const ScanRow* row : counted_scans(result)) counts.push_back(*row->counts);
  return counts;
}

}  // namespace mosbench
