#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

Pose at(double x_m, double y_m, double yaw_rad) {
  Pose pose = Pose::Identity();
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  pose.translation() = Eigen::Vector3d(x_m, y_m, 0.0);
  return pose;
}

std::vector<Pose> straight(std::size_t rows, double step_m) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < rows; ++i) poses.push_back(at(step_m * static_cast<double>(i), 0, 0));
  return poses;
}

std::vector<Pose> with_noise(std::vector<Pose> poses, double noise_m) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, noise_m);
  for (Pose& pose : poses) {
    pose.translation() += Eigen::Vector3d(noise(random), noise(random), noise(random));
    pose.rotate(Eigen::AngleAxisd(0.1 * noise(random), Eigen::Vector3d::UnitZ()));
  }
  return poses;
}

TEST(SuspectedRows, AreAnyTwoThatWereExchanged) {
  constexpr std::size_t kRows = 14;
  for (std::size_t first = 0; first < kRows; ++first) {
    for (std::size_t second = first + 1; second < kRows; ++second) {
      auto poses = with_noise(straight(kRows, 0.8), 0.01);
      std::swap(poses[first], poses[second]);
      const auto suspected = suspected_rows(poses);
      ASSERT_EQ(suspected.size(), 1U) << first << " " << second;
      EXPECT_EQ(suspected.front().first, first);
      EXPECT_EQ(suspected.front().last, second);
    }
  }
}

TEST(SuspectedRows, AreASingleOneOffTheWay) {
  for (const std::size_t row : {1U, 7U, 18U}) {
    auto poses = straight(20, 0.8);
    poses[row].translation().y() += 40.0;
    const auto suspected = suspected_rows(poses);
    ASSERT_EQ(suspected.size(), 1U) << row;
    EXPECT_TRUE(suspected.front().single());
    EXPECT_EQ(suspected.front().first, row);
  }
}

TEST(SuspectedRows, AreSeveralPairs) {
  auto poses = straight(60, 0.8);
  std::swap(poses[10], poses[40]);
  std::swap(poses[20], poses[21]);
  std::swap(poses[50], poses[52]);
  EXPECT_EQ(suspected_rows(poses).size(), 3U);
}

TEST(SuspectedRows, AreNoneOnAWayThatTurnsStopsOrJumpsOn) {
  std::vector<Pose> poses;
  for (int i = 0; i < 30; ++i) poses.push_back(at(0.5 * i, 0, 0));
  for (int i = 0; i < 10; ++i) poses.push_back(at(15.0, 0, 0.3 * i));  // turns on the spot
  for (int i = 0; i < 30; ++i) poses.push_back(at(15.0 - 0.5 * i, 0, M_PI));
  for (int i = 0; i < 20; ++i) poses.push_back(at(0, 0, M_PI));  // stands
  for (int i = 0; i < 30; ++i)
    poses.push_back(at(9.0 + 0.8 * i, 4.0, 0.0));  // a closed loop's jump
  EXPECT_TRUE(suspected_rows(poses).empty());
  EXPECT_TRUE(suspected_rows(with_noise(poses, 0.01)).empty());
}

TEST(SuspectedRows, AreNoneOfASensorThatStandsOrASequenceOfAFewScans) {
  const std::vector<Pose> standing(40, Pose::Identity());
  EXPECT_TRUE(suspected_rows(standing).empty());
  EXPECT_TRUE(suspected_rows(with_noise(standing, 0.02)).empty());
  for (std::size_t rows = 0; rows < 4; ++rows) {
    EXPECT_TRUE(suspected_rows(straight(rows, 0.8)).empty()) << rows;
  }
}

TEST(Mended, PutsASingleRowMidwayAndExchangesTwo) {
  const auto poses = straight(5, 1.0);
  EXPECT_DOUBLE_EQ(mended(poses, {1, 3})[3].translation().x(), 1.0);
  EXPECT_DOUBLE_EQ(mended(poses, {1, 3})[1].translation().x(), 3.0);
  auto off = poses;
  off[2].translation().z() = 9.0;
  EXPECT_TRUE(mended(off, {2, 2})[2].isApprox(poses[2]));
}

}  // namespace
}  // namespace mosbench
