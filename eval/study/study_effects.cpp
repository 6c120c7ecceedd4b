#include "eval/study/study_effects.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace mosbench {
namespace {

/// IoU of each cell of one row, by what the cell sets and by sequence.
using IousBySettings = std::map<std::vector<SettingChange>, std::map<std::string, double>>;

/// All cells of one method with its poses.
struct SampledRow {
  const Segment* segment;
  std::set<std::string> sequences;
  IousBySettings ious;

  /// Mean over sequences at one value of the axis; nothing where one is missing or undefined.
  std::optional<double> iou(const StudyAxis& axis, std::size_t value) const {
    const auto found = ious.find(changes_of(*segment, axis, value));
    if (found == ious.end() || found->second.size() != sequences.size()) return std::nullopt;
    double sum = 0;
    for (const auto& [sequence, each] : found->second) sum += each;
    return sum / static_cast<double>(sequences.size());
  }
};

std::map<std::string, SampledRow> rows_of(const StudyPlan& plan, std::vector<std::string>& labels) {
  std::map<std::string, SampledRow> rows;
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    const auto [row, is_new] =
        rows.try_emplace(cell.label(), SampledRow{&cell.method->segment, {}, {}});
    if (is_new) labels.push_back(row->first);
    row->second.sequences.insert(cell.sequence_label());
    if (planned.state != CellState::kDone) continue;
    if (const auto iou = planned.numbers.metrics[0]) {
      row->second.ious[cell.job.segment.changes][cell.sequence_label()] = *iou;
    }
  }
  return rows;
}

/// IoU at each whole point: first with all settings as drawn, then with each drawn anew.
std::vector<std::vector<double>> ious_of(const SampledRow& row, const StudyAxis& axis) {
  const std::size_t stride = axis.sampled.size() + 1;
  std::vector<std::vector<double>> ious(stride);
  for (std::size_t first = 0; first < axis.values.size(); first += stride) {
    std::vector<std::optional<double>> point;
    for (std::size_t i = 0; i < stride; ++i) point.push_back(row.iou(axis, first + i));
    if (!std::ranges::all_of(point, [](const auto& iou) { return iou.has_value(); })) continue;
    for (std::size_t i = 0; i < stride; ++i) ious[i].push_back(*point[i]);
  }
  return ious;
}

}  // namespace

std::vector<StudyEffects> effects_of(const StudyPlan& plan, const StudyAxis& axis) {
  std::vector<std::string> labels;
  const auto rows = rows_of(plan, labels);
  std::vector<StudyEffects> all;
  for (const std::string& label : labels) {
    const SampledRow& row = rows.at(label);
    const auto ious = ious_of(row, axis);
    StudyEffects& effects = all.emplace_back(StudyEffects{label, ious.front().size(), {}, {}});
    for (std::size_t i = 0; i < axis.sampled.size(); ++i) {
      if (row.segment->method->defaults.find(axis.sampled[i]) == nullptr) continue;
      effects.settings.push_back(axis.sampled[i]);
      effects.effects.push_back(total_effect(ious.front(), ious[i + 1]));
    }
    if (effects.settings.empty()) all.pop_back();
  }
  return all;
}

}  // namespace mosbench
