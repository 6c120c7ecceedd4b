#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/job/tuned_preset.hpp"
#include "eval/study/done_cells.hpp"

namespace mosbench {

/// Metrics where settings were chosen, and where they are judged; nothing while cells are missing.
struct TunedAndJudged {
  std::optional<StudyMetrics> tuned, judged;
};

/// The settings of a row that were chosen from the grid.
struct StudyChoice {
  std::string label;                  ///< of the row
  std::string why_none;               ///< no settings are chosen; empty where some are
  std::optional<TunedPreset> preset;  ///< of the chosen ones
  std::size_t candidates = 0;
  std::size_t passed_over = 0;  ///< candidates that failed, or have no metric
  TunedAndJudged chosen, base;  ///< of the chosen settings, and of the preset without them
};

/// Returns the choice of each row whose method has settings of the grid: the first of the best in
/// the grid's order. It looks at no cell of the sequences to be judged on.
std::vector<StudyChoice> choices_of(const StudyPlan& plan, const DoneCells& cells);

/// Returns that a sequence is judged which is another seed of a scene that is tuned on; empty for
/// none.
std::string doubt_about_judging(const StudyPlan& plan);

/// Throws UsageError where a file of the name that a row's preset gets is not one of a study.
void check_presets(const StudyPlan& plan);

/// Writes the file of each choice below the study's folder where it holds something else. Throws
/// DataError.
void write_presets(const std::vector<StudyChoice>& choices);

}  // namespace mosbench
