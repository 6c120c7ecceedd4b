#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mosbench {

/// How an estimate is moved onto the truth before positions are compared.
enum class PathAlignment : std::uint8_t {
  kNone,
  kOrigin,     ///< its first pose onto the true first pose
  kRigid,      ///< least squares over positions (Umeyama, PAMI 1991)
  kSimilarity  ///< the same with a scale
};

std::string_view to_string(PathAlignment alignment);
std::optional<PathAlignment> path_alignment_from_string(std::string_view name);

struct AlignedPath {
  std::vector<Pose> poses;
  double scale = 1;
};

/// Nothing where least squares have no single answer: fewer than three positions, or all on a line.
std::optional<AlignedPath> aligned(std::span<const Pose> estimate, std::span<const Pose> truth,
                                   PathAlignment alignment);

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

/// Which pieces of a path are compared.
struct SegmentRule {
  std::string_view name;
  std::vector<double> lengths_m;
  std::size_t step_scans;  ///< between starts
};

/// Of KITTI's odometry benchmark: 100, 200, ... 800 m from every tenth pose.
const SegmentRule& kitti_segments();
/// For paths too short for it: 5, 10, 20 and 50 m from every pose. Not comparable with KITTI's.
const SegmentRule& short_segments();

/// Error of the motion over one piece of the path, per metre of its nominal length.
struct SegmentError {
  std::size_t first, last;  ///< poses
  double length_m;
  double translation;  ///< metres per metre
  double rotation_rad_per_m;
};

/// As KITTI's devkit (Geiger et al., CVPR 2012) computes them, rounding to float32 where it does: a
/// segment from pose i ends at the first pose whose distance along the true path exceeds that of i
/// by more than the length. Poses are inverted as matrices, since rows of 6 digits are no exact
/// rotations.
std::vector<SegmentError> segment_errors(std::span<const Pose> truth,
                                         std::span<const Pose> estimate, const SegmentRule& rule);

/// Means over segments of any number of sequences; nothing without segments.
struct MeanSegmentError {
  std::size_t segments = 0;
  double translation = 0, rotation_rad_per_m = 0;
};
std::optional<MeanSegmentError> mean_of(std::span<const SegmentError> errors);

}  // namespace mosbench
