#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/engine/study_plan.hpp"
#include "eval/statistics/total_effect.hpp"
#include "eval/study/done_cells.hpp"
#include "eval/study/tuning.hpp"

namespace mosbench {

/// How much each sampled setting of a method decides its IoU.
struct StudyEffects {
  std::string label;       ///< of the row
  std::size_t points = 0;  ///< whose cells are all done, and defined on all sequences
  std::vector<std::string> settings;
  std::vector<std::optional<TotalEffect>> effects;  ///< of the IoU's mean over sequences
};

/// A method with its poses, on all sequences without any disturbance.
struct StudyRow {
  std::string label;
  StudyMetrics metrics;
  std::optional<StudyMean> to_best;  ///< IoU minus that of the best row, paired; not of that row
  std::optional<double> ms_per_scan;
  bool is_on_front = false;    ///< none is as good and as fast, and better in one
  std::optional<double> rank;  ///< mean over sequences of its place, 1 the best
  std::vector<std::string> doubts{};
};

/// Metrics of every row by the strength of one disturbance, or by the value of one setting.
struct StudyCurve {
  std::string axis, unit;
  std::vector<std::string> values;  ///< first "none", of a setting "default of preset best"
  std::vector<std::vector<StudyMetrics>> metrics;  ///< by row, by value
  bool is_grid = false;                            ///< of combinations of settings
};

/// What cannot be shown, and why.
struct StudyGap {
  std::string title, why;
};

/// One of the worst scans of a row, and the command that shows it.
struct StudyWorst {
  std::string label, title, stem, command;
  double iou;
};

/// All that a study found.
struct StudyTable {
  std::string name;
  std::string out;         ///< folder of the results
  bool simulated = false;  ///< any of its data
  std::vector<std::string> doubts;
  std::optional<ScoreRule> rule;
  std::string unchanged;  ///< see `default_title`
  std::vector<StudyRow> rows;
  std::vector<StudyCurve> curves;
  std::vector<StudyEffects> effects;
  std::vector<StudyChoice> choices;  ///< of a tuning, by row
  std::size_t ranked_sequences = 0;
  /// Two mean ranks that are farther apart differ at 5 % (Nemenyi; Demsar 2006, eq. 5 and table 5).
  std::optional<double> critical_difference;
  std::vector<StudyWorst> worst;
  std::vector<StudyGap> failures;
  std::vector<StudyGap> missing;    ///< cells that are still to be computed
  std::vector<StudyGap> undefined;  ///< cells that have no IoU, precision or recall
  std::size_t cells = 0, done = 0;
  /// Time of one core for what is done, and what costs.json said of it. Programs of the user's
  /// count for as long as they last.
  std::optional<double> core_s, predicted_s;
};

/// Why a cell that is done lacks a metric, "undefined recall: no point that counts moves"; empty
/// where it lacks none.
std::string why_undefined(const PlannedCell& planned);

/// Gathers what lies there.
StudyTable gather(const StudyPlan& plan);

nlohmann::ordered_json to_json(const StudyTable& table);
/// Says what a study found; CSV has a row per cell, and HTML is a page of its own with the curves.
/// The exit code is 1 while cells are missing.
Answer study_answer(const StudyPlan& plan, const StudyTable& table);

}  // namespace mosbench
