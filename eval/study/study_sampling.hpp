#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "eval/statistics/total_effect.hpp"
#include "eval/study/study_plan.hpp"

namespace mosbench {

/// A setting that is drawn evenly between two legal values.
struct SampledSetting {
  std::string name;
  double low, high;
  bool is_whole;
};

/// Draws all settings at once, after Saltelli et al. 2010: per point a value with all of them, and
/// one for each setting with that one drawn anew. Numbers have six digits. The same arguments give
/// the same values on every machine.
StudyAxis sampled_axis(const std::vector<SampledSetting>& settings, std::size_t points,
                       std::uint64_t seed);

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
