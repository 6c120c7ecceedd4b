#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

constexpr double kStepS = 0.1;

/// A way of 60 poses with noise: `position_m` says where a sensor is after so many seconds.
template <typename PositionAt>
std::vector<Pose> way(PositionAt&& position_m, double noise_m, double step_s = kStepS) {
  std::mt19937 bits(3);
  std::normal_distribution<double> noise(0.0, std::max(noise_m, 1e-9));
  std::vector<Pose> poses(60, Pose::Identity());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    poses[k].translation() = position_m(static_cast<double>(k) * step_s);
    if (noise_m > 0.0) {
      poses[k].translation() += Eigen::Vector3d(noise(bits), noise(bits), noise(bits));
    }
  }
  return poses;
}

/// Whether poses that do not fit the scans are said to scatter.
bool is_found(const PoseScatter& scatter) {
  Facts facts;
  facts["scatter_m"] = scatter.noise_m;
  facts["whiteness"] = scatter.whiteness;
  facts["acceleration_m_s2"] = scatter.acceleration_m_s2;
  facts["unsound"] = 1.5;
  for (const char* word : {"off_m", "motions", "overlap", "best_overlap"}) facts[word] = 0.0;
  return !judged(checks(), Subject::kPoses, facts, "way").empty();
}

Eigen::Vector3d straight_drive(double time_s) { return {20.0 * time_s, 0.0, 0.0}; }

TEST(PoseScatter, MeasuresTheNoiseOfAStraightWay) {
  EXPECT_NEAR(scatter_of(way(straight_drive, 0.1), kStepS).noise_m, 0.1, 0.02);
  EXPECT_TRUE(is_found(scatter_of(way(straight_drive, 0.1), kStepS)));
}

TEST(PoseScatter, IsNotFoundInSoundNoise) {
  EXPECT_NEAR(scatter_of(way(straight_drive, 0.05), kStepS).noise_m, 0.05, 0.01);
  EXPECT_FALSE(is_found(scatter_of(way(straight_drive, 0.05), kStepS)));
}

TEST(PoseScatter, IsNotFoundOnSmoothWays) {
  const auto turning = [](double time_s) -> Eigen::Vector3d {
    return {8.0 * std::cos(1.5 * time_s), 8.0 * std::sin(1.5 * time_s), 0.0};
  };
  const auto walking = [](double time_s) -> Eigen::Vector3d {
    return {1.4 * time_s, 0.03 * std::sin(6.0 * time_s), 0.04 * std::sin(12.0 * time_s)};
  };
  const auto lifted = [](double time_s) -> Eigen::Vector3d {
    return {0.0, 0.0, time_s < 2.0 ? 0.0 : 1.5 * (time_s - 2.0)};
  };
  EXPECT_GT(scatter_of(way(turning, 0.0), kStepS).acceleration_m_s2, 12.0) << "a hard turn";
  EXPECT_FALSE(is_found(scatter_of(way(turning, 0.0), kStepS)));
  EXPECT_FALSE(is_found(scatter_of(way(walking, 0.02), kStepS)));
  EXPECT_FALSE(is_found(scatter_of(way(lifted, 0.05), kStepS)));
}

TEST(PoseScatter, IsNotFoundWhereScansAreSecondsApart) {
  const std::vector<Pose> poses = way(straight_drive, 0.5, 2.0);
  EXPECT_GT(scatter_of(poses, 2.0).noise_m, 0.3) << "as large as a driver's own changes of speed";
  EXPECT_FALSE(is_found(scatter_of(poses, 2.0)));
}

TEST(PoseScatter, IsUnknownWithFewPoses) {
  std::vector<Pose> poses = way(straight_drive, 0.3);
  poses.resize(12);
  EXPECT_FALSE(is_found(scatter_of(poses, kStepS)));
}

}  // namespace
}  // namespace mosbench
