#pragma once

#include <span>
#include <vector>

#include "eval/answer/line_chart.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {

/// Charts of one sequence as one or two estimates see it: from above beside the truth, and the
/// distance to it over the way driven. `alignment` is stated.
std::vector<LineChart> trajectory_charts(std::span<const TrajectoryScore* const> estimates,
                                         PathAlignment alignment);

}  // namespace mosbench
