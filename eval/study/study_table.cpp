#include "eval/study/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ranges>
#include <set>
#include <utility>

namespace mosbench {
namespace {

/// Mean of optional numbers; nothing where one is missing, and of none.
std::optional<double> mean_of(auto&& values) {
  double sum = 0, count = 0;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

StudyRow row_of(const DoneCells& cells, const std::string& label) {
  const auto is_plain = is_plain_of(label);
  std::vector<std::optional<double>> ms;
  StudyRow row;
  for (const DoneCell& each : cells.done) {
    if (!is_plain(each.cell)) continue;
    ms.push_back(each.numbers.ms_per_scan);
    std::ranges::copy(each.numbers.doubts, std::back_inserter(row.doubts));
  }
  row.label = label;
  row.metrics = cells.metrics(is_plain);
  row.ms_per_scan = mean_of(ms);
  return row;
}

/// Compares all rows with the best on the sequences that both have.
void compare_with_best(const DoneCells& cells, std::vector<StudyRow>& rows) {
  const auto iou = [](const StudyRow& row) { return row.metrics[0].value.value_or(-1); };
  const auto best = std::ranges::max_element(rows, {}, iou);
  if (best == rows.end() || !best->metrics[0].value) return;
  const CellsOfSeeds of_best = cells.by_seed(is_plain_of(best->label));
  for (StudyRow& row : rows) {
    if (row.label == best->label) continue;
    const auto ious = differences(*cells.protocol, of_best, cells.by_seed(is_plain_of(row.label)));
    row.to_best = {mean_of_estimates(ious, {-1, 1}), ious.size()};
  }
}

void mark_front(std::vector<StudyRow>& rows) {
  std::vector<IouAndTime> runs;
  for (const StudyRow& row : rows) runs.push_back({row.metrics[0].value, row.ms_per_scan});
  const std::vector<bool> front = pareto_front(runs);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].is_on_front = front[i];
}

/// The curve of an axis. A grid that settings are chosen from shows nothing of the sequences on
/// which they are judged.
StudyCurve curve_of(const StudyPlan& plan, const DoneCells& cells, const StudyAxis& axis,
                    const std::string& unchanged) {
  StudyCurve curve;
  curve.axis = axis.name;
  curve.is_grid = axis.is_grid;
  if (axis.kind != nullptr) curve.unit = axis.kind->unit;
  curve.values = {axis.kind != nullptr ? "none" : unchanged};
  curve.values.insert(curve.values.end(), axis.values.begin(), axis.values.end());
  const StudyTuning* tuning = axis.is_grid && plan.study->tuning ? &*plan.study->tuning : nullptr;
  const auto metrics = [&](const WantedCell& wanted) {
    return cells.metrics([&](const StudyCell& cell) {
      return wanted(cell) && (tuning == nullptr || names_sequence(tuning->tune_on, cell));
    });
  };
  for (const std::string& label : cells.labels) {
    std::vector<StudyMetrics>& line = curve.metrics.emplace_back();
    line.push_back(metrics(is_plain_of(label)));
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      line.push_back(metrics(is_at_value(label, axis, i)));
    }
  }
  return curve;
}

/// Mean IoU of each label on a sequence over everything that was done to it but other settings;
/// nothing where one lacks a cell.
std::optional<std::vector<double>> scores_on(const StudyPlan& plan, const DoneCells& cells,
                                             const std::string& sequence) {
  std::vector<std::vector<std::optional<double>>> values(cells.labels.size());
  for (const PlannedCell& planned : plan.cells) {
    const StudyCell& cell = planned.cell;
    if (cell.group_label() != sequence) continue;
    if (cell.axis != nullptr && cell.axis->kind == nullptr) continue;
    const auto label = std::ranges::find(cells.labels, cell.label()) - cells.labels.begin();
    const bool done = planned.state == CellState::kDone;
    values[static_cast<std::size_t>(label)].push_back(done ? planned.numbers.metrics[0]
                                                           : std::nullopt);
  }
  std::vector<double> scores;
  for (const auto& of_label : values) {
    const auto mean = mean_of(of_label);
    if (!mean || of_label.size() != values.front().size()) return std::nullopt;
    scores.push_back(*mean);
  }
  return scores;
}

/// Places from 1, the mean place for equals.
std::vector<double> places_of(const std::vector<double>& scores) {
  std::vector<double> places;
  for (const double score : scores) {
    const auto better = std::ranges::count_if(scores, [&](double s) { return s > score; });
    const auto equal = std::ranges::count(scores, score);
    places.push_back(static_cast<double>(better) + (static_cast<double>(equal) + 1) / 2);
  }
  return places;
}

/// Studentized range at 5 % and infinite freedom, divided by the root of 2, for 2 to 10 methods.
constexpr std::array<double, 9> kNemenyi = {1.960, 2.343, 2.569, 2.728, 2.850,
                                            2.949, 3.031, 3.102, 3.164};

void rank(const StudyPlan& plan, const DoneCells& cells, StudyTable& table) {
  const std::size_t methods = table.rows.size();
  if (methods < 2) return;
  std::vector<std::string> sequences;
  for (const PlannedCell& planned : plan.cells) {
    const std::string sequence = planned.cell.group_label();
    if (std::ranges::find(sequences, sequence) == sequences.end()) sequences.push_back(sequence);
  }
  std::vector<double> sums(methods);
  for (const std::string& sequence : sequences) {
    const auto scores = scores_on(plan, cells, sequence);
    if (!scores) continue;
    ++table.ranked_sequences;
    const std::vector<double> places = places_of(*scores);
    for (std::size_t i = 0; i < methods; ++i) sums[i] += places[i];
  }
  const double count = static_cast<double>(table.ranked_sequences);
  if (table.ranked_sequences < 2) return;
  for (std::size_t i = 0; i < methods; ++i) table.rows[i].rank = sums[i] / count;
  if (methods - 2 >= kNemenyi.size()) return;
  const double k = static_cast<double>(methods);
  table.critical_difference = kNemenyi[methods - 2] * std::sqrt(k * (k + 1) / (6 * count));
}

std::string command_for(const StudyPlan& plan, const StudyCell& cell) {
  Job job = cell.job;
  job.data.path = place_of(plan.out, job.data);
  const std::string runs = "results/runs/" + cell.key.substr(0, 12);
  return fmt::format("{} --out {} && mosbench report {} -o worst.html", to_words(job), runs, runs);
}

/// The worst scan of the worst cells of each label.
void list_worst(const StudyPlan& plan, const DoneCells& cells, StudyTable& table) {
  constexpr std::size_t kOfEach = 3;
  for (const std::string& label : cells.labels) {
    std::vector<const PlannedCell*> worst;
    for (const DoneCell& each : cells.done) {
      if (each.label == label && each.numbers.worst) worst.push_back(each.planned);
    }
    std::ranges::stable_sort(worst, {}, [](const PlannedCell* planned) {
      return std::pair(planned->numbers.worst->iou, -planned->numbers.worst->wrong);
    });
    worst.resize(std::min(worst.size(), kOfEach));
    for (const PlannedCell* planned : worst) {
      const BadScan& scan = *planned->numbers.worst;
      table.worst.push_back(
          {label, planned->cell.title(), scan.stem, command_for(plan, planned->cell), scan.iou});
    }
  }
}

void count_cells(const StudyPlan& plan, StudyTable& table) {
  const CostModel costs = read_costs(plan.out);
  double core_s = 0, predicted_s = 0;
  bool all_predicted = true;
  std::vector<Doubt> doubts;
  for (const PlannedCell& planned : plan.cells) {
    ++table.cells;
    if (planned.state == CellState::kFailed) {
      table.failures.push_back({planned.cell.title(), planned.failure});
    }
    if (planned.state == CellState::kMissing || planned.state == CellState::kOtherVersion) {
      table.missing.push_back({planned.cell.title(), std::string(to_string(planned.state))});
    }
    if (planned.state != CellState::kDone) continue;
    const std::string why = why_undefined(planned);
    if (!why.empty()) table.undefined.push_back({planned.cell.title(), why});
    ++table.done;
    table.simulated = table.simulated || planned.numbers.simulated;
    for (const auto& doubt : planned.numbers.doubts)
      doubts.push_back({planned.cell.title(), doubt});
    core_s += planned.numbers.core_s.value_or(0);
    const auto expected_s = costs.seconds(planned.cell);
    all_predicted = all_predicted && expected_s.has_value();
    predicted_s += expected_s.value_or(0);
  }
  table.doubts = told_by_kind(doubts);
  const std::string judging = doubt_about_judging(plan);
  if (!judging.empty()) table.doubts.push_back(judging);
  if (table.done == 0) return;
  table.core_s = core_s;
  if (all_predicted) table.predicted_s = predicted_s;
}

/// IoU of the cells of one row, by what they set and by sequence.
using Ious = std::map<std::vector<SettingChange>, std::map<std::string, std::optional<double>>>;

/// Mean IoU of a row at each whole point: first with all settings as drawn, then with each drawn
/// anew. A point counts where all of its cells are done, and defined, on all sequences.
std::vector<std::vector<double>> sampled_ious(const Ious& ious, std::size_t sequences,
                                              const Segment& segment, const StudyAxis& axis) {
  const std::size_t stride = axis.sampled.size() + 1;
  std::vector<std::vector<double>> sampled(stride);
  for (std::size_t first = 0; first < axis.values.size(); first += stride) {
    std::vector<double> point;
    for (std::size_t i = first; i < first + stride; ++i) {
      const auto found = ious.find(changes_of(segment, axis, i));
      if (found == ious.end() || found->second.size() != sequences) break;
      const auto mean = mean_of(std::views::values(found->second));
      if (mean) point.push_back(*mean);
    }
    if (point.size() < stride) continue;
    for (std::size_t i = 0; i < stride; ++i) sampled[i].push_back(point[i]);
  }
  return sampled;
}

/// Gathers what is done of a sampled axis, per method with its poses.
std::vector<StudyEffects> effects_of(const StudyPlan& plan, const DoneCells& cells,
                                     const StudyAxis& axis) {
  std::map<std::string, const Segment*> segments;
  std::map<std::string, std::set<std::string>> sequences;
  std::map<std::string, Ious> ious;
  for (const PlannedCell& planned : plan.cells) {
    const std::string label = planned.cell.label();
    segments[label] = &planned.cell.method->segment;
    sequences[label].insert(planned.cell.sequence_label());
  }
  for (const DoneCell& each : cells.done) {
    ious[each.label][each.cell.job.segment.changes][each.cell.sequence_label()] =
        each.numbers.metrics[0];
  }
  std::vector<StudyEffects> all;
  for (const std::string& label : cells.labels) {
    const Segment& segment = *segments[label];
    const auto sampled = sampled_ious(ious[label], sequences[label].size(), segment, axis);
    StudyEffects effects{label, sampled.front().size(), {}, {}};
    for (std::size_t i = 0; i < axis.sampled.size(); ++i) {
      if (segment.method->defaults.find(axis.sampled[i]) == nullptr) continue;
      effects.settings.push_back(axis.sampled[i]);
      effects.effects.push_back(total_effect(sampled.front(), sampled[i + 1]));
    }
    if (!effects.settings.empty()) all.push_back(std::move(effects));
  }
  return all;
}

}  // namespace

std::string why_undefined(const PlannedCell& planned) {
  if (planned.state != CellState::kDone) return "";
  if (planned.numbers.counts.empty()) return "undefined: no scan has truth that counts";
  std::string text;
  for (std::size_t i = 0; i < kBriefMetrics.size(); ++i) {
    if (planned.numbers.metrics[i]) continue;
    const MetricRow& row = row_of(kBriefMetrics[i]);
    text +=
        fmt::format("{}undefined {}: {}", text.empty() ? "" : "; ", row.title, row.undefined_where);
    if (i == 0) break;  // the others are, too, for the same reason
  }
  return text;
}

StudyTable gather(const StudyPlan& plan) {
  StudyTable table;
  table.name = plan.study->name;
  table.out = plan.out.string();
  table.rule = plan.rule;
  table.unchanged = default_title(plan);
  const DoneCells cells(plan);
  for (const std::string& label : cells.labels) table.rows.push_back(row_of(cells, label));
  mark_front(table.rows);
  compare_with_best(cells, table.rows);
  for (const StudyAxis& axis : plan.study->axes) {
    if (axis.sampled.empty()) {
      table.curves.push_back(curve_of(plan, cells, axis, table.unchanged));
    } else {
      table.effects = effects_of(plan, cells, axis);
    }
  }
  if (plan.study->tuning) table.choices = choices_of(plan, cells);
  rank(plan, cells, table);
  list_worst(plan, cells, table);
  count_cells(plan, table);
  return table;
}

}  // namespace mosbench
