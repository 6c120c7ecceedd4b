#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
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

}  // namespace mosbench
