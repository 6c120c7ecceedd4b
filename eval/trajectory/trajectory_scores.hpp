#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/statistics/intervals.hpp"
#include "eval/trajectory/pose_errors.hpp"
#include "eval/trajectory/trajectory.hpp"

namespace mosbench {

/// How good one estimate is.
struct TrajectoryScore {
  std::string name;
  std::size_t poses = 0;
  double path_m = 0;  ///< of the truth
  std::vector<SegmentError> kitti, brief;
  double scale = 1;  ///< that the estimate was multiplied with
  PoseErrors absolute, relative;
  std::vector<Eigen::Vector3d> truth_m, estimate_m;  ///< positions, aligned
  std::vector<std::string> remarks;
};

struct ScoringRules {
  PathAlignment alignment = PathAlignment::kNone;
  RelativePairs relative;
};

/// Throws DataError where the alignment is undefined.
TrajectoryScore score_of(const TrajectoryPair& pair, const ScoringRules& rules);

/// A table of the sequences, all of them pooled and their mean; below it what was paired and
/// aligned how.
Sheet trajectory_sheet(std::span<const TrajectoryScore> scores, const ScoringRules& rules);
/// Numbers in metres, radians and fractions; with `per_pose` also the errors of every pose and
/// segment.
nlohmann::ordered_json trajectory_json(std::span<const TrajectoryScore> scores,
                                       const ScoringRules& rules, bool per_pose);
/// One row per pose and sequence: absolute errors.
Sheet pose_records(std::span<const TrajectoryScore> scores);
/// Charts of one sequence as one or two estimates see it: from above beside the truth, and the
/// distance to it over the way driven. `alignment` is stated.
std::vector<LineChart> trajectory_charts(std::span<const TrajectoryScore* const> estimates,
                                         PathAlignment alignment);

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
