#pragma once

#include <vector>

#include "eval/engine/run_plan.hpp"
#include "eval/study/study_plan.hpp"

namespace mosbench {

/// What `mosbench run` would be told of a cell, but where its data lie and how they are read.
RunOptions scoring_options(const StudyCell& cell, const Study& study);

/// Returns the rule by which all cells are scored; nothing where the settings of all are refused,
/// which fail when they are computed. Throws UsageError where cells differ in it: a mean over them
/// would mean nothing.
std::optional<ScoreRule> shared_rule(const Study& study, const std::vector<StudyCell>& cells);

}  // namespace mosbench
