#include "datasets/sequence/registration.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace mosbench {
namespace {

std::vector<Point> corner() {
  std::vector<Point> points;
  for (int i = 0; i < 120; ++i) {
    for (int k = 0; k < 40; ++k) {
      const float along = 0.1F * static_cast<float>(i) - 6.0F, up = 0.1F * static_cast<float>(k);
      points.push_back({8.4F, along, up, 0.0F});
      points.push_back({along, 7.4F, up, 0.0F});
    }
  }
  return points;
}

TEST(Registration, FindsHowACornerMoved) {
  Pose motion = Pose::Identity();
  motion.rotate(Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ()));
  motion.translation() = Eigen::Vector3d(0.3, -0.2, 0.0);
  std::vector<Point> later = corner();
  for (Point& point : later) {
    const Eigen::Vector3f moved =
        (motion.inverse() * Eigen::Vector3d(point.x, point.y, point.z)).cast<float>();
    point = {moved.x(), moved.y(), moved.z(), 0.0F};
  }
  const Registration found =
      registered(RegisteredScan(corner(), 1.0), RegisteredScan(later, 1.0), Pose::Identity());
  EXPECT_NEAR(found.motion.translation().x(), 0.3, 0.01);
  EXPECT_NEAR(found.motion.translation().y(), -0.2, 0.01);
  EXPECT_TRUE(found.motion.linear().isApprox(motion.linear(), 1e-3));
  EXPECT_GT(found.overlap, 0.7);
}

TEST(Registration, EndsForPosesWithoutEnd) {
  const RegisteredScan scan(corner(), 1.0);
  for (const double far_m : {1e9, 1e308, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    Pose start = Pose::Identity();
    start.translation().x() = far_m;
    EXPECT_EQ(registered(scan, scan, start).overlap, 0.0) << far_m;
  }
}

}  // namespace
}  // namespace mosbench
