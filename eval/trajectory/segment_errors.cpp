#include "eval/trajectory/segment_errors.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench {
namespace {

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

float angle_of(const Eigen::Matrix4d& error) {
  const auto a = static_cast<float>(error(0, 0)), b = static_cast<float>(error(1, 1)),
             c = static_cast<float>(error(2, 2));
  const auto cosine = static_cast<float>(0.5 * (static_cast<double>(a + b + c) - 1.0));
  return std::acos(std::clamp(cosine, -1.0F, 1.0F));
}

}  // namespace

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
                        static_cast<double>(angle_of(error)) / length_m});
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
