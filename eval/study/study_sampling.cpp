#include "eval/study/study_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

/// The n-th number of one setting's stream, as text for --set.
std::string drawn(const SampledSetting& setting, std::uint64_t stream, std::uint64_t n) {
  const double part = uniform(random_word(stream, n));
  if (setting.is_whole) {
    return fmt::format("{:.0f}", setting.low + std::floor(part * (setting.high - setting.low + 1)));
  }
  const std::string number =
      fmt::format("{:.6g}", setting.low + part * (setting.high - setting.low));
  // Digits that are cut must not lead out of what is legal.
  return fmt::format("{}", std::clamp(std::stod(number), setting.low, setting.high));
}

/// IoU of each cell of one row, by what the cell sets and by sequence.
using IousBySettings = std::map<std::vector<std::string>, std::map<std::string, double>>;

/// All cells of one method with its poses.
struct SampledRow {
  const StudyMethod* method;
  std::set<std::string> sequences;
  IousBySettings ious;

  /// Mean over sequences at one value of the axis; nothing where one is missing or undefined.
  std::optional<double> iou(const StudyAxis& axis, std::size_t value) const {
    const auto found = ious.find(assignments_of(*method, axis, value));
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
    const auto [row, is_new] = rows.try_emplace(cell.label(), SampledRow{cell.method, {}, {}});
    if (is_new) labels.push_back(row->first);
    row->second.sequences.insert(cell.sequence_label());
    if (planned.state != CellState::kDone) continue;
    if (const auto iou = number_in(planned.record, "summary", "iou")) {
      row->second.ious[cell.assignments][cell.sequence_label()] = *iou;
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

StudyAxis sampled_axis(const std::vector<SampledSetting>& settings, std::size_t points,
                       std::uint64_t seed) {
  StudyAxis axis;
  axis.name = "sample";
  for (const SampledSetting& setting : settings) axis.sampled.push_back(setting.name);
  for (std::size_t point = 0; point < points; ++point) {
    std::vector<StudyAssignment> all;
    for (std::size_t i = 0; i < settings.size(); ++i) {
      all.push_back({settings[i].name, drawn(settings[i], random_word(seed, i), 2 * point)});
    }
    axis.values.push_back(std::to_string(point + 1));
    axis.assignments.push_back(all);
    for (std::size_t i = 0; i < settings.size(); ++i) {
      axis.values.push_back(fmt::format("{} {}", point + 1, settings[i].name));
      axis.assignments.push_back(all);
      axis.assignments.back()[i].value = drawn(settings[i], random_word(seed, i), 2 * point + 1);
    }
  }
  return axis;
}

std::vector<StudyEffects> effects_of(const StudyPlan& plan, const StudyAxis& axis) {
  std::vector<std::string> labels;
  const auto rows = rows_of(plan, labels);
  std::vector<StudyEffects> all;
  for (const std::string& label : labels) {
    const SampledRow& row = rows.at(label);
    const auto ious = ious_of(row, axis);
    StudyEffects& effects = all.emplace_back(StudyEffects{label, ious.front().size(), {}, {}});
    for (std::size_t i = 0; i < axis.sampled.size(); ++i) {
      if (!has_setting(*row.method, axis.sampled[i])) continue;
      effects.settings.push_back(axis.sampled[i]);
      effects.effects.push_back(total_effect(ious.front(), ious[i + 1]));
    }
    if (effects.settings.empty()) all.pop_back();
  }
  return all;
}

}  // namespace mosbench
