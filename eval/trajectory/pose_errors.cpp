#include "eval/trajectory/pose_errors.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "eval/trajectory/trajectory.hpp"

namespace mosbench {
namespace {

using Positions = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr std::array<std::string_view, 4> kAlignmentNames = {"none", "origin", "rigid",
                                                             "similarity"};
// Singular values below this share of the largest are none.
constexpr double kOnALine = 1e-12;

Positions positions_of(std::span<const Pose> poses) {
  Positions positions(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
  }
  return positions;
}

bool has_single_answer(const Positions& from, const Positions& to) {
  const Positions from_mean = from.colwise() - from.rowwise().mean();
  const Positions to_mean = to.colwise() - to.rowwise().mean();
  const Eigen::Vector3d singular =
      Eigen::JacobiSVD<Eigen::Matrix3d>(to_mean * from_mean.transpose()).singularValues();
  return singular[1] > kOnALine * singular[0];
}

constexpr double kDeltaTolerance = 0.1;

double angle_of(const Eigen::Matrix3d& rotation) {
  // By the quaternion, which keeps small angles of rows with 6 digits.
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  return 2 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

IndexPairs pairs_by_scans(std::size_t poses, const RelativePairs& pairs) {
  IndexPairs found;
  const std::size_t step = pairs.all ? 1 : pairs.delta_scans;
  for (std::size_t i = 0; i + pairs.delta_scans < poses; i += step) {
    found.emplace_back(i, i + pairs.delta_scans);
  }
  return found;
}

IndexPairs consecutive_pairs(const std::vector<double>& path_m, double delta_m) {
  IndexPairs found;
  std::optional<std::size_t> start;
  double cut_m = 0;
  for (std::size_t i = 0; i < path_m.size(); ++i) {
    if (path_m[i] - cut_m < delta_m) continue;
    if (start) found.emplace_back(*start, i);
    start = i;
    cut_m = path_m[i];
  }
  return found;
}

IndexPairs all_pairs(const std::vector<double>& path_m, double delta_m) {
  IndexPairs found;
  for (std::size_t i = 0; i < path_m.size(); ++i) {
    const auto begin = path_m.begin() + static_cast<std::ptrdiff_t>(i);
    const double end_m = path_m[i] + delta_m;
    auto nearest = std::lower_bound(begin, path_m.end(), end_m);
    if (nearest == path_m.end() ||
        (nearest != begin && end_m - *(nearest - 1) <= *nearest - end_m)) {
      --nearest;
    }
    // The first of those that are equally near.
    nearest = std::lower_bound(begin, nearest, *nearest);
    if (std::abs(*nearest - end_m) > kDeltaTolerance * delta_m) continue;
    found.emplace_back(i, static_cast<std::size_t>(nearest - path_m.begin()));
  }
  return found;
}

IndexPairs pairs_of(std::span<const Pose> estimate, const RelativePairs& pairs) {
  if (!pairs.delta_m) return pairs_by_scans(estimate.size(), pairs);
  const std::vector<double> path_m = path_lengths_m({estimate.begin(), estimate.end()});
  return pairs.all ? all_pairs(path_m, *pairs.delta_m) : consecutive_pairs(path_m, *pairs.delta_m);
}

std::vector<float> distances_m(std::span<const Pose> truth) {
  std::vector<float> distances(truth.size(), 0.0F);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Eigen::Vector3f step =
        (truth[i - 1].translation() - truth[i].translation()).cast<float>();
    distances[i] = distances[i - 1] +
                   std::sqrt(step.x() * step.x() + step.y() * step.y() + step.z() * step.z());
  }
  return distances;
}

Eigen::Matrix4d motion(const Pose& from, const Pose& to) {
  return from.matrix().inverse() * to.matrix();
}

float devkit_angle(const Eigen::Matrix4d& error) {
  const auto a = static_cast<float>(error(0, 0)), b = static_cast<float>(error(1, 1)),
             c = static_cast<float>(error(2, 2));
  const auto cosine = static_cast<float>(0.5 * (static_cast<double>(a + b + c) - 1.0));
  return std::acos(std::clamp(cosine, -1.0F, 1.0F));
}

}  // namespace

std::string_view to_string(PathAlignment alignment) {
  return kAlignmentNames[static_cast<std::size_t>(alignment)];
}

std::optional<PathAlignment> path_alignment_from_string(std::string_view name) {
  const auto found = std::ranges::find(kAlignmentNames, name);
  if (found == kAlignmentNames.end()) return std::nullopt;
  return static_cast<PathAlignment>(found - kAlignmentNames.begin());
}

std::optional<AlignedPath> aligned(std::span<const Pose> estimate, std::span<const Pose> truth,
                                   PathAlignment alignment) {
  AlignedPath result{.poses = {estimate.begin(), estimate.end()}};
  if (alignment == PathAlignment::kNone) return result;
  if (alignment == PathAlignment::kOrigin) {
    const Pose move = truth.front() * estimate.front().inverse();
    for (Pose& pose : result.poses) pose = move * pose;
    return result;
  }
  const Positions from = positions_of(estimate), to = positions_of(truth);
  if (estimate.size() < 3 || !has_single_answer(from, to)) return std::nullopt;
  const Eigen::Matrix4d move = Eigen::umeyama(from, to, alignment == PathAlignment::kSimilarity);
  result.scale = std::cbrt(move.topLeftCorner<3, 3>().determinant());
  const Eigen::Matrix3d rotation = move.topLeftCorner<3, 3>() / result.scale;
  for (Pose& pose : result.poses) {
    pose.translation() =
        result.scale * (rotation * pose.translation()) + move.topRightCorner<3, 1>();
    pose.linear() = rotation * pose.linear();
  }
  return result;
}

PoseErrors absolute_errors(std::span<const Pose> truth, std::span<const Pose> estimate) {
  PoseErrors errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors.translation_m.push_back((estimate[i].translation() - truth[i].translation()).norm());
    errors.rotation_rad.push_back(angle_of(estimate[i].linear().transpose() * truth[i].linear()));
  }
  return errors;
}

PoseErrors relative_errors(std::span<const Pose> truth, std::span<const Pose> estimate,
                           const RelativePairs& pairs) {
  PoseErrors errors;
  for (const auto& [i, j] : pairs_of(estimate, pairs)) {
    const Pose true_motion = truth[i].inverse() * truth[j];
    const Pose error = true_motion.inverse() * (estimate[i].inverse() * estimate[j]);
    errors.translation_m.push_back(error.translation().norm());
    errors.rotation_rad.push_back(angle_of(error.linear()));
  }
  return errors;
}

std::optional<ErrorSummary> summary_of(std::span<const double> errors) {
  if (errors.empty()) return std::nullopt;
  std::vector<double> sorted(errors.begin(), errors.end());
  std::ranges::sort(sorted);
  const auto count = static_cast<double>(sorted.size());
  ErrorSummary summary{.count = sorted.size(), .least = sorted.front(), .most = sorted.back()};
  for (const double error : errors) {
    summary.mean += error / count;
    summary.squares += error * error;
  }
  double variance = 0;
  for (const double error : errors) {
    variance += (error - summary.mean) * (error - summary.mean) / count;
  }
  summary.rmse = std::sqrt(summary.squares / count);
  summary.deviation = std::sqrt(variance);
  const std::size_t middle = sorted.size() / 2;
  summary.median =
      sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
  return summary;
}

const SegmentRule& kitti_segments() {
  static const SegmentRule rule{"kitti", {100, 200, 300, 400, 500, 600, 700, 800}, 10};
  return rule;
}

const SegmentRule& short_segments() {
  static const SegmentRule rule{"short", {5, 10, 20, 50}, 1};
  return rule;
}

std::vector<SegmentError> segment_errors(std::span<const Pose> truth,
                                         std::span<const Pose> estimate, const SegmentRule& rule) {
  const std::vector<float> distances = distances_m(truth);
  std::vector<SegmentError> errors;
  for (std::size_t first = 0; first < truth.size(); first += rule.step_scans) {
    for (const double length_m : rule.lengths_m) {
      const float end_m = distances[first] + static_cast<float>(length_m);
      const auto behind = std::upper_bound(distances.begin() + static_cast<std::ptrdiff_t>(first),
                                           distances.end(), end_m);
      if (behind == distances.end()) continue;
      const auto last = static_cast<std::size_t>(behind - distances.begin());
      const Eigen::Matrix4d error =
          motion(estimate[first], estimate[last]).inverse() * motion(truth[first], truth[last]);
      errors.push_back({first, last, length_m, error.block<3, 1>(0, 3).norm() / length_m,
                        static_cast<double>(devkit_angle(error)) / length_m});
    }
  }
  return errors;
}

std::optional<MeanSegmentError> mean_of(std::span<const SegmentError> errors) {
  if (errors.empty()) return std::nullopt;
  MeanSegmentError mean{.segments = errors.size()};
  for (const SegmentError& error : errors) {
    mean.translation += error.translation;
    mean.rotation_rad_per_m += error.rotation_rad_per_m;
  }
  mean.translation /= static_cast<double>(errors.size());
  mean.rotation_rad_per_m /= static_cast<double>(errors.size());
  return mean;
}

}  // namespace mosbench
