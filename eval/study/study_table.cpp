#include "eval/study/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "datasets/files/shell_text.hpp"
#include "eval/results/reading_json.hpp"
#include "eval/statistics/distributions.hpp"
#include "eval/statistics/pareto_front.hpp"
#include "eval/study/study_cell.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Values by sequence, then by seed.
using Samples = std::map<std::string, std::vector<std::optional<double>>>;

std::optional<double> mean_of(const std::vector<std::optional<double>>& values) {
  double sum = 0;
  for (const auto& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  if (values.empty()) return std::nullopt;
  return sum / static_cast<double>(values.size());
}

StudyMean study_mean(const Samples& samples) {
  std::vector<std::optional<double>> values;
  if (samples.size() == 1) {
    values = samples.begin()->second;
  } else {
    for (const auto& [sequence, of_seeds] : samples) values.push_back(mean_of(of_seeds));
  }
  StudyMean mean;
  mean.value = mean_of(values);
  mean.count = values.size();
  if (!mean.value || values.size() < 2) return mean;
  const double count = static_cast<double>(values.size());
  double squares = 0;
  for (const auto& value : values) squares += (*value - *mean.value) * (*value - *mean.value);
  mean.half_width = student_quantile(1 - (1 - kConfidence) / 2, count - 1) *
                    std::sqrt(squares / (count - 1) / count);
  mean.interval = Interval{std::max(0.0, *mean.value - mean.half_width),
                           std::min(1.0, *mean.value + mean.half_width)};
  return mean;
}

/// A computed cell, with the names under which a table gathers it.
struct DoneCell {
  const PlannedCell* planned;
  std::string label, sequence;

  const StudyCell& cell() const { return planned->cell; }
  const ordered_json& record() const { return planned->record; }
};

/// The cells that were computed, as a table is made of them.
class DoneCells {
 public:
  explicit DoneCells(const StudyPlan& plan) {
    for (const PlannedCell& planned : plan.cells) {
      std::string label = planned.cell.label();
      if (std::ranges::find(labels, label) == labels.end()) labels.push_back(label);
      if (planned.state != CellState::kDone) continue;
      done.push_back({&planned, std::move(label), planned.cell.sequence_label()});
    }
  }

  template <typename Wanted>
  StudyMetrics metrics(Wanted&& wanted) const {
    std::array<Samples, kStudyMetrics.size()> samples;
    for (const DoneCell& each : done) {
      if (!wanted(each)) continue;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i][each.sequence].push_back(number_in(each.record(), "summary", kStudyMetrics[i]));
      }
    }
    StudyMetrics metrics;
    std::ranges::transform(samples, metrics.begin(), study_mean);
    return metrics;
  }

  std::vector<std::string> labels;
  std::vector<DoneCell> done;
};

StudyRow row_of(const DoneCells& cells, const std::string& label) {
  const auto is_plain = [&](const DoneCell& each) {
    return each.cell().axis == nullptr && each.label == label;
  };
  std::vector<std::optional<double>> ms;
  for (const DoneCell& each : cells.done) {
    if (is_plain(each)) ms.push_back(number_in(each.record(), "timing", "ms_per_scan"));
  }
  return {label, cells.metrics(is_plain), mean_of(ms), false, std::nullopt};
}

void mark_front(std::vector<StudyRow>& rows) {
  std::vector<IouAndTime> runs;
  for (const StudyRow& row : rows) runs.push_back({row.metrics[0].value, row.ms_per_scan});
  const std::vector<bool> front = pareto_front(runs);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].is_on_front = front[i];
}

StudyCurve curve_of(const DoneCells& cells, const StudyAxis& axis,
                    const std::vector<StudyRow>& rows) {
  StudyCurve curve;
  curve.axis = axis.name;
  if (axis.kind != nullptr) curve.unit = axis.kind->unit;
  curve.values = {"none"};
  curve.values.insert(curve.values.end(), axis.values.begin(), axis.values.end());
  for (const StudyRow& row : rows) {
    std::vector<StudyMetrics>& line = curve.metrics.emplace_back();
    line.push_back(row.metrics);
    for (const std::string& value : axis.values) {
      line.push_back(cells.metrics([&](const DoneCell& each) {
        return each.cell().axis == &axis && each.cell().value == value && each.label == row.label;
      }));
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
    if (cell.sequence_label() != sequence) continue;
    if (cell.axis != nullptr && cell.axis->kind == nullptr) continue;
    const auto label = std::ranges::find(cells.labels, cell.label()) - cells.labels.begin();
    const bool done = planned.state == CellState::kDone;
    values[static_cast<std::size_t>(label)].push_back(
        done ? number_in(planned.record, "summary", "iou") : std::nullopt);
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
    const std::string sequence = planned.cell.sequence_label();
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
  const std::string data = cell.data->simulation ? simulated_folder(plan.out, *cell.data).string()
                                                 : cell.data->path.string();
  std::string command = fmt::format("mosbench run {} --sequences {} --method {}", shell_word(data),
                                    shell_word(cell.sequence), shell_word(cell.method->method));
  ReadingOptions reading = cell.data->reading;
  reading.perturb = cell.perturb();
  command += told_flags(reading);
  if (cell.data->dataset != "auto") command += " --dataset " + shell_word(cell.data->dataset);
  if (plan.study->protocol) command += " --protocol " + shell_word(*plan.study->protocol);
  if (plan.study->range) command += " --range " + shell_word(*plan.study->range);
  if (cell.method->preset) command += " --preset " + shell_word(*cell.method->preset);
  if (!cell.odometry.empty()) command += " --odometry " + shell_word(cell.odometry);
  for (const std::string& set : cell.assignments) command += " --set " + shell_word(set);
  const std::string runs = "results/runs/" + cell.key.substr(0, 12);
  return fmt::format("{} --out {} && mosbench report {} -o worst.html", command, runs, runs);
}

struct BadScan {
  double iou = 0;
  std::string stem;
  const StudyCell* cell = nullptr;
};

/// The worst scans of each label, of any cell.
void list_worst(const StudyPlan& plan, const DoneCells& cells, StudyTable& table) {
  constexpr std::size_t kOfEach = 3;
  for (const std::string& label : cells.labels) {
    std::vector<BadScan> worst;
    for (const DoneCell& each : cells.done) {
      if (each.label != label || !each.record().contains("worst")) continue;
      for (const ordered_json& scan : each.record().at("worst")) {
        worst.push_back({scan.value("iou", 0.0), scan.value("stem", ""), &each.cell()});
      }
    }
    std::ranges::stable_sort(worst, {}, &BadScan::iou);
    worst.resize(std::min(worst.size(), kOfEach));
    for (const BadScan& scan : worst) {
      table.worst.push_back(
          {label, scan.cell->title(), scan.stem, command_for(plan, *scan.cell), scan.iou});
    }
  }
}

void count_cells(const StudyPlan& plan, StudyTable& table) {
  const CostModel costs = read_costs(plan.out);
  double seconds = 0, predicted_s = 0;
  bool all_predicted = true;
  for (const PlannedCell& planned : plan.cells) {
    ++table.cells;
    if (planned.state == CellState::kFailed) {
      table.failures.push_back({planned.cell.title(), planned.record.value("failure", "")});
    }
    if (planned.state != CellState::kDone) continue;
    ++table.done;
    table.simulated = table.simulated || planned.record.value("simulated", false);
    seconds += number_in(planned.record, "timing", "wall_s").value_or(0);
    const auto expected_s = costs.seconds(planned.cell);
    all_predicted = all_predicted && expected_s.has_value();
    predicted_s += expected_s.value_or(0);
  }
  if (table.done == 0) return;
  table.hours = seconds / 3600;
  if (all_predicted) table.predicted_hours = predicted_s / 3600;
}

}  // namespace

StudyTable gather(const StudyPlan& plan) {
  StudyTable table;
  table.name = plan.study->name;
  table.out = plan.out.string();
  const DoneCells cells(plan);
  for (const std::string& label : cells.labels) table.rows.push_back(row_of(cells, label));
  mark_front(table.rows);
  for (const StudyAxis& axis : plan.study->axes) {
    if (axis.sampled.empty()) {
      table.curves.push_back(curve_of(cells, axis, table.rows));
    } else {
      table.effects = effects_of(plan, axis);
    }
  }
  rank(plan, cells, table);
  list_worst(plan, cells, table);
  count_cells(plan, table);
  return table;
}

}  // namespace mosbench
