#pragma once

#include <span>

#include "eval/answer/picture.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {

/// Draws one sequence as one or two estimates see it: from above beside the truth, and the distance
/// to it over the way driven. `alignment` is stated.
Picture trajectory_plot(std::span<const TrajectoryScore* const> estimates, PathAlignment alignment);

}  // namespace mosbench
