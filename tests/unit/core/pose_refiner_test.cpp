#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <mosbench/pose_refiner.hpp>
#include <vector>

#include "tests/odometry_scenes.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kScans = 30;

/// A drive along the street with a slight turn, far from the origin.
std::vector<Pose> true_drive(int scans = kScans) {
  std::vector<Pose> poses;
  for (int k = 0; k < scans; ++k) poses.push_back(pose_at({0.5 * k, 0.02 * k, 0.0}, 0.002 * k));
  return poses;
}

Pose far_away() { return pose_at({4000.0, -900.0, 30.0}, 0.7); }

/// Refines `given` by what the sensor saw from `truth`; both begin far away.
RefinedPoses refined(const std::vector<Pose>& truth, const std::vector<Pose>& given) {
  PoseRefiner refiner;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    refiner.push(scene_points(street(), truth[k], static_cast<int>(k)), far_away() * given[k]);
  }
  return refiner.finish();
}

/// How far the motion over ten scans is off, in the median.
double off_m(const std::vector<Pose>& truth, const std::vector<Pose>& poses) {
  std::vector<double> all_m;
  for (std::size_t k = 10; k < truth.size(); ++k) {
    const Pose moved = truth[k - 10].inverse() * truth[k];
    const Pose found = poses[k - 10].inverse() * poses[k];
    all_m.push_back((moved.inverse() * found).translation().norm());
  }
  std::ranges::nth_element(all_m, all_m.begin() + static_cast<std::ptrdiff_t>(all_m.size() / 2));
  return all_m[all_m.size() / 2];
}

/// Poses whose motions are all a little too long and turn too far.
std::vector<Pose> drifting(const std::vector<Pose>& truth) {
  std::vector<Pose> poses = {truth.front()};
  for (std::size_t k = 1; k < truth.size(); ++k) {
    poses.push_back(poses.back() * truth[k - 1].inverse() * truth[k] *
                    pose_at({0.02, 0.03, 0.01}, 0.001));
  }
  return poses;
}

TEST(PoseRefiner, CorrectsADriftThatTheScansShow) {
  const std::vector<Pose> truth = true_drive(), given = drifting(truth);
  ASSERT_GT(off_m(truth, given), 0.25);
  const RefinedPoses poses = refined(truth, given);
  ASSERT_EQ(poses.map_from_sensor.size(), truth.size());
  EXPECT_LT(off_m(truth, poses.map_from_sensor), 0.05);
  EXPECT_GT(poses.corrected, 25U);
  EXPECT_THAT(poses.failed, IsEmpty());
  EXPECT_LT(poses.fit_m, 0.7 * poses.given_fit_m);
}

TEST(PoseRefiner, LeavesTheFirstPoseWhereItIs) {
  const std::vector<Pose> truth = true_drive(12);
  const RefinedPoses poses = refined(truth, drifting(truth));
  ASSERT_GT(poses.corrected, 0U);
  EXPECT_EQ(poses.map_from_sensor.front().matrix(), (far_away() * truth.front()).matrix());
}

TEST(PoseRefiner, KeepsPosesThatFitAlready) {
  const std::vector<Pose> truth = true_drive();
  const RefinedPoses poses = refined(truth, truth);
  EXPECT_EQ(poses.corrected, 0U);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_EQ(poses.map_from_sensor[k].matrix(), (far_away() * truth[k]).matrix());
  }
}

TEST(PoseRefiner, CorrectsTheMotionsAroundAJumpAlone) {
  const std::vector<Pose> truth = true_drive(40);
  std::vector<Pose> given = truth;
  for (std::size_t k = 20; k < given.size(); ++k) {
    given[k] = pose_at({0.0, 0.3, 0.0}, 0.0) * given[k];
  }
  const RefinedPoses poses = refined(truth, given);
  EXPECT_GT(poses.corrected, 0U);
  EXPECT_LT(poses.corrected, 15U);
  const auto step_m = [](const std::vector<Pose>& drive) {
    return (drive[19].inverse() * drive[20]).translation().y();
  };
  ASSERT_NEAR(step_m(given) - step_m(truth), 0.3, 0.01);
  EXPECT_NEAR(step_m(poses.map_from_sensor), step_m(truth), 0.03);
}

TEST(PoseRefiner, MovesAScanThatCannotBeRegisteredAsGiven) {
  const std::vector<Pose> truth = true_drive(12), given = drifting(truth);
  PoseRefiner refiner;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const bool is_lost = k == 6;
    refiner.push(
        is_lost ? std::vector<Point>(500) : scene_points(street(), truth[k], static_cast<int>(k)),
        given[k]);
  }
  EXPECT_THAT(refiner.finish().failed, ElementsAre(6U));
}

TEST(PoseRefiner, KeepsPosesThatScansContradictByMetres) {
  // The scans show a sensor that stands; the poses say that it moves by 3 m a scan.
  std::vector<Pose> given;
  for (int k = 0; k < 5; ++k) given.push_back(pose_at({3.0 * k, 0, 0}, 0));
  const RefinedPoses poses = refined(std::vector<Pose>(5, Pose::Identity()), given);
  EXPECT_EQ(poses.corrected, 0U);
}

TEST(PoseRefiner, FollowsTheGivenPosesOverLongStretches) {
  // Poses that are off by a wave of 6 m over 400 scans: registration sees motions that differ by
  // little, and adding up what it finds would lose the wave.
  constexpr int kLong = 400;
  const std::vector<Point> points =
      scene_scan(street(), Pose::Identity(), {.rings = 20, .columns = 180}).points;
  PoseRefiner refiner;
  std::vector<Pose> given;
  for (int k = 0; k < kLong; ++k) {
    given.push_back(pose_at({0.0, 3.0 - 3.0 * std::cos(2 * 3.14159265 * k / kLong), 0.0}, 0.0));
    refiner.push(points, given.back());
  }
  const RefinedPoses poses = refiner.finish();
  ASSERT_GT(poses.corrected, 100U);
  const double at_most_m = poses.map_from_sensor[kLong / 2].translation().y();
  EXPECT_GT(at_most_m, 1.0);
  EXPECT_LT(at_most_m, 6.0);
}

TEST(PoseRefiner, GivesNoPoseForNoScanAndOneForOne) {
  PoseRefiner refiner;
  EXPECT_THAT(refiner.finish().map_from_sensor, IsEmpty());
  refiner.push({}, far_away());
  const RefinedPoses poses = refiner.finish();
  ASSERT_EQ(poses.map_from_sensor.size(), 1U);
  EXPECT_EQ(poses.map_from_sensor.front().matrix(), far_away().matrix());
}

}  // namespace
}  // namespace mosbench
