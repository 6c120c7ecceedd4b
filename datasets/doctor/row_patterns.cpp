#include "datasets/doctor/row_patterns.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {

std::vector<RowRange> equal_rows(const std::vector<Pose>& poses) {
  std::vector<RowRange> runs;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    if (poses[row].matrix() != poses[row - 1].matrix()) continue;
    if (runs.empty() || runs.back().last != row - 1) runs.push_back({row - 1, row});
    runs.back().last = row;
  }
  return runs;
}

std::vector<std::size_t> odd_steps(const std::vector<Pose>& poses, std::size_t most) {
  constexpr std::size_t kAround = 4;
  std::vector<double> steps_m;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    steps_m.push_back(difference_m(poses[row - 1], poses[row]));
  }
  std::vector<std::pair<double, std::size_t>> odd;
  for (std::size_t i = 0; i < steps_m.size(); ++i) {
    const std::size_t from = i < kAround ? 0 : i - kAround;
    const std::size_t to = std::min(i + kAround + 1, steps_m.size());
    const double usual_m = median({steps_m.begin() + static_cast<std::ptrdiff_t>(from),
                                   steps_m.begin() + static_cast<std::ptrdiff_t>(to)});
    odd.emplace_back(std::abs(steps_m[i] - usual_m), i + 1);
  }
  std::ranges::sort(odd, std::ranges::greater());
  odd.resize(std::min(odd.size(), most));
  std::vector<std::size_t> rows;
  for (const auto& [unused, row] : odd) rows.push_back(row);
  return rows;
}

bool all_rotations_equal(const std::vector<Pose>& poses) {
  return std::ranges::all_of(poses, [&](const Pose& pose) {
    return pose.linear().isApprox(poses.front().linear(), 1e-9);
  });
}

std::optional<int> constant_axis(const std::vector<Pose>& poses) {
  constexpr double kNowhereM = 1e-6, kSomewhereM = 1.0, kUpright = 1e-6;
  Eigen::Vector3d low = poses.front().translation(), high = low;
  double least_upright = 1.0, most_upright = -1.0;
  for (const Pose& pose : poses) {
    low = low.cwiseMin(pose.translation());
    high = high.cwiseMax(pose.translation());
    least_upright = std::min(least_upright, pose.linear()(2, 2));
    most_upright = std::max(most_upright, pose.linear()(2, 2));
  }
  const Eigen::Vector3d span_m = high - low;
  if (span_m.maxCoeff() < kSomewhereM || most_upright - least_upright < kUpright) {
    return std::nullopt;
  }
  for (const int axis : {2, 1, 0}) {
    if (span_m[axis] < kNowhereM) return axis;
  }
  return std::nullopt;
}

}  // namespace mosbench
