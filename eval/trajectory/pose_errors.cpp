#include "eval/trajectory/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "eval/trajectory/trajectory.hpp"

namespace mosbench {
namespace {

constexpr double kDeltaTolerance = 0.1;

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

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

}  // namespace

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

}  // namespace mosbench
