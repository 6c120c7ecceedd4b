#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/engine/study_plan.hpp"
#include "eval/statistics/total_effect.hpp"

namespace mosbench {

/// How much each sampled setting of a method decides its IoU.
struct StudyEffects {
  std::string label;       ///< of the row
  std::size_t points = 0;  ///< whose cells are all done, and defined on all sequences
  std::vector<std::string> settings;
  std::vector<std::optional<TotalEffect>> effects;  ///< of the IoU's mean over sequences
};

/// Gathers what is done of a sampled axis, per method with its poses.
std::vector<StudyEffects> effects_of(const StudyPlan& plan, const StudyAxis& axis);

}  // namespace mosbench
