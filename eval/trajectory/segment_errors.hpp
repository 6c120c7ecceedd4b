#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mosbench {

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
