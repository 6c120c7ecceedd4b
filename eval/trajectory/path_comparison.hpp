#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/statistics/intervals.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {

/// One kind of error of two estimates of the same paths. Numbers in metres, radians and fractions.
struct PathDifference {
  std::string_view name;                ///< "kitti_translation"
  std::string_view title;               ///< "KITTI %"
  double shown_factor;                  ///< of the numbers under that title
  std::optional<double> first, second;  ///< over all sequences
  Difference difference;                ///< second - first
};

/// Throws DataError unless both are estimates of the same true poses, in the same order.
void check_same_truth(std::span<const TrajectoryPair> first,
                      std::span<const TrajectoryPair> second);

/// Differences between two estimates of the same paths: of the mean errors of segments, pooled over
/// the sequences, and of the root mean squares of APE and RPE. Both estimates have the same
/// segments, so that what makes a segment hard cancels. The intervals are those of `difference_of`
/// over the poses where segments or motions begin. There is none for APE: one bad motion shifts all
/// later positions.
std::vector<PathDifference> compare_paths(std::span<const TrajectoryScore> first,
                                          std::span<const TrajectoryScore> second);

Sheet path_differences_sheet(std::span<const PathDifference> differences);
nlohmann::ordered_json path_differences_json(std::span<const PathDifference> differences);
/// A row per kind of error.
Sheet path_difference_records(std::span<const PathDifference> differences);

}  // namespace mosbench
