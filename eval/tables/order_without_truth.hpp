#pragma once

#include <cstddef>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// How labels fit what other scans see at the places of points.
struct SeenAgain {
  std::size_t moving_left = 0, moving_kept = 0;  ///< points labelled moving
  std::size_t static_left = 0, static_kept = 0;

  /// IoU of the points labelled moving and those that left their place; 1 where there are neither.
  double agreement() const;
};

/// Looks at up to a dozen scans of each sequence for all runs at once, which must be of the same
/// scans and poses. Throws DataError, also for a run without labels.
std::vector<SeenAgain> seen_again(const std::vector<ResultSet>& runs);

/// Says a row per run, the one that agrees most first.
Answer order_without_truth(const std::vector<ResultSet>& runs);

}  // namespace mosbench
