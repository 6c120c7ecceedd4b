#include "eval/trajectory/trajectory_scores.hpp"

#include <fmt/format.h>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

// First poses farther apart than this are hardly in the same frame.
constexpr double kFarStart_m = 5.0;

std::string_view what_is_missing(PathAlignment alignment) {
  return alignment == PathAlignment::kRigid ? "rigid alignment is undefined"
                                            : "similarity alignment is undefined";
}

std::vector<Eigen::Vector3d> positions_m(const std::vector<Pose>& poses) {
  std::vector<Eigen::Vector3d> positions;
  for (const Pose& pose : poses) positions.emplace_back(pose.translation());
  return positions;
}

}  // namespace

TrajectoryScore score_of(const TrajectoryPair& pair, const ScoringRules& rules) {
  const auto estimate = aligned(pair.estimate, pair.truth, rules.alignment);
  if (!estimate) {
    throw DataError(pair.name + ": the positions lie on a line, so that " +
                    std::string(what_is_missing(rules.alignment)) +
                    ", expected --align none or origin");
  }
  TrajectoryScore score{.name = pair.name,
                        .poses = pair.truth.size(),
                        .path_m = path_lengths_m(pair.truth).back(),
                        .kitti = segment_errors(pair.truth, pair.estimate, kitti_segments()),
                        .brief = segment_errors(pair.truth, pair.estimate, short_segments()),
                        .scale = estimate->scale,
                        .absolute = absolute_errors(pair.truth, estimate->poses),
                        .relative = relative_errors(pair.truth, estimate->poses, rules.relative),
                        .truth_m = positions_m(pair.truth),
                        .estimate_m = positions_m(estimate->poses),
                        .remarks = pair.remarks};
  const double apart_m =
      (pair.truth.front().translation() - estimate->poses.front().translation()).norm();
  if (rules.alignment == PathAlignment::kNone && apart_m > kFarStart_m) {
    score.remarks.push_back(fmt::format(
        "the first poses are {:.1f} m apart, which --align origin would take out", apart_m));
  }
  return score;
}

}  // namespace mosbench
