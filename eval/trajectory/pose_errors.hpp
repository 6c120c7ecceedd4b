#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

namespace mosbench {

/// Errors of positions (m) and rotations (rad) that run together.
struct PoseErrors {
  std::vector<double> translation_m, rotation_rad;
};

/// Absolute: |t_estimate - t_truth| and the angle of R_estimate^-1 R_truth, of every pose. The
/// estimate has been aligned.
PoseErrors absolute_errors(std::span<const Pose> truth, std::span<const Pose> estimate);

/// Between which poses motion is compared.
struct RelativePairs {
  std::optional<double>
      delta_m;  ///< of the estimated path; `delta_scans` counts when there is none
  std::size_t delta_scans = 1;
  bool all = false;  ///< every start, instead of one after the other without overlap
};

/// Relative: those of E = (G_i^-1 G_j)^-1 (P_i^-1 P_j). In metres, one after the other, a piece
/// ends where the estimated path since the last end reaches delta, and the first such end is the
/// first start; with all pairs, a piece ends at the pose whose distance is nearest to delta, if
/// within 10 % of it.
PoseErrors relative_errors(std::span<const Pose> truth, std::span<const Pose> estimate,
                           const RelativePairs& pairs);

/// Summary of a list of errors; the deviation is that of the population.
struct ErrorSummary {
  std::size_t count = 0;
  double rmse = 0, mean = 0, median = 0, deviation = 0, least = 0, most = 0, squares = 0;
};
/// Nothing of no errors.
std::optional<ErrorSummary> summary_of(std::span<const double> errors);

}  // namespace mosbench
