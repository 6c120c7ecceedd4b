#include "datasets/simulator/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/scene_cast.hpp"

namespace mosbench {
namespace {

Route there_and_on(AfterRoute after) {
  return {.from_m = {0.0, 0.0},
          .legs = {{.to_m = {4.0, 0.0}, .speed_m_s = 2.0, .wait_s = 1.0},
                   {.to_m = {4.0, 3.0}, .speed_m_s = 1.0, .wait_s = 2.0}},
          .after = after,
          .start_s = 10.0};
}

TEST(Route, WaitsWalksStopsAndStarts) {
  const Route route = there_and_on(AfterRoute::kStay);
  EXPECT_DOUBLE_EQ(route_duration_s(route), 8.0);
  EXPECT_EQ(route_state(route, 9.0).speed_m_s, 0.0);
  EXPECT_EQ(route_state(route, 10.5).speed_m_s, 0.0);
  const RouteState walking = route_state(route, 12.0);
  EXPECT_DOUBLE_EQ(walking.position_m.x(), 2.0);
  EXPECT_DOUBLE_EQ(walking.speed_m_s, 2.0);
  EXPECT_DOUBLE_EQ(walking.heading.x(), 1.0);
  const RouteState standing = route_state(route, 14.0);
  EXPECT_DOUBLE_EQ(standing.position_m.x(), 4.0);
  EXPECT_EQ(standing.speed_m_s, 0.0);
  EXPECT_DOUBLE_EQ(route_state(route, 16.0).position_m.y(), 1.0);
  const RouteState arrived = route_state(route, 100.0);
  EXPECT_DOUBLE_EQ(arrived.position_m.y(), 3.0);
  EXPECT_EQ(arrived.speed_m_s, 0.0);
}

TEST(Route, GoesBackTheWayItCame) {
  const Route route = there_and_on(AfterRoute::kReturn);
  const RouteState back = route_state(route, 10.0 + 8.0 + 1.0);
  EXPECT_DOUBLE_EQ(back.position_m.y(), 2.0);
  EXPECT_DOUBLE_EQ(back.heading.y(), -1.0);
  EXPECT_DOUBLE_EQ(back.speed_m_s, 1.0);
}

TEST(Route, BeginsAgain) {
  const Route route = there_and_on(AfterRoute::kRestart);
  EXPECT_DOUBLE_EQ(route_state(route, 12.0 + 8.0).position_m.x(), 2.0);
}

TEST(Ground, IsTheHighestOfItsPlanes) {
  const std::vector<GroundPlane> ground = {{.height_m = 0.0}, {.height_m = -1.0, .slope_x = 0.1}};
  EXPECT_DOUBLE_EQ(ground_height_m(ground, 5.0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(ground_height_m(ground, 20.0, 0.0), 1.0);
  EXPECT_EQ(ground_height_m({}, 20.0, 0.0), 0.0);
}

TEST(EgoPose, IsARotationThatMovesSmoothly) {
  for (const SceneSummary& summary : built_in_scenes()) {
    const Scene scene = built_in_scene(summary.name);
    Pose before = ego_pose(scene, 0.0);
    for (int i = 1; i < 2000; ++i) {
      const Pose pose = ego_pose(scene, 0.1 * i);
      const Eigen::Matrix3d r = pose.linear();
      ASSERT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-12);
      ASSERT_GT(r.determinant(), 0.0);
      const double turned = (before.linear().transpose() * r - Eigen::Matrix3d::Identity()).norm();
      // A room's robot turns round at the walls, between two scans.
      const double most = summary.name == "room" ? 3.0 : 0.5;
      ASSERT_LT(turned, most) << summary.name << " scan " << i;
      before = pose;
    }
  }
}

TEST(EgoPose, StandsStillOnATripod) {
  Scene scene;
  scene.ego.carrier = Carrier::kTripod;
  scene.ego.sensor_height_m = 1.5;
  EXPECT_TRUE(ego_pose(scene, 0.0).matrix() == ego_pose(scene, 7.3).matrix());
  EXPECT_DOUBLE_EQ(ego_pose(scene, 0.0).translation().z(), 1.5);
}

const OwnerState& last_owner(const SceneSnapshot& snapshot) { return snapshot.owners.back(); }

TEST(SceneSnapshot, CallsObjectsMovingAboveTheirKindsSpeed) {
  Scene scene;
  const auto moving_at = [&](MoverKind kind, double speed_m_s) {
    scene.movers = {
        {.kind = kind, .route = {.legs = {{.to_m = {100.0, 0.0}, .speed_m_s = speed_m_s}}}}};
    return last_owner(snapshot(scene, 1.0)).moving;
  };
  EXPECT_FALSE(moving_at(MoverKind::kPedestrian, 0.5));
  EXPECT_TRUE(moving_at(MoverKind::kPedestrian, 0.51));
  EXPECT_TRUE(moving_at(MoverKind::kCyclist, 0.51));
  EXPECT_FALSE(moving_at(MoverKind::kCar, 1.0));
  EXPECT_TRUE(moving_at(MoverKind::kTruck, 1.01));
}

TEST(SceneSnapshot, KnowsWhatLooksDynamicWhileItStands) {
  Scene scene;
  scene.movers = {{.kind = MoverKind::kPedestrian, .route = {}}};
  EXPECT_TRUE(last_owner(snapshot(scene, 0.0)).dynamic_by_appearance);
  EXPECT_FALSE(last_owner(snapshot(scene, 0.0)).moving);
  scene.movers[0].kind = MoverKind::kCar;
  EXPECT_FALSE(last_owner(snapshot(scene, 0.0)).dynamic_by_appearance);
  scene.movers[0].dynamic_by_appearance = true;
  EXPECT_TRUE(last_owner(snapshot(scene, 0.0)).dynamic_by_appearance);
}

TEST(SceneSnapshot, ThrowsABallThatFliesFreelyAndThenLies) {
  Scene scene;
  scene.balls = {{.from_m = {0.0, 0.0, 1.0}, .velocity_m_s = {2.0, 0.0, 3.0}, .radius_m = 0.1}};
  const SceneSnapshot flying = snapshot(scene, 0.5);
  EXPECT_NEAR(flying.solids.back().center_m.x(), 1.0, 1e-12);
  EXPECT_NEAR(flying.solids.back().center_m.z(), 1.0 + 1.5 - 0.5 * 9.81 * 0.25, 1e-12);
  EXPECT_TRUE(last_owner(flying).moving);
  const SceneSnapshot lying = snapshot(scene, 3.0);
  EXPECT_NEAR(lying.solids.back().center_m.z(), 0.1, 1e-9);
  EXPECT_FALSE(last_owner(lying).moving);
  EXPECT_TRUE(last_owner(lying).dynamic_by_appearance);
}

TEST(SceneSnapshot, SwingsADoorOpenAndShut) {
  Scene scene;
  scene.doors = {{.width_m = 1.2, .closed_yaw_rad = 0.0, .open_yaw_rad = 1.5, .swing_s = 1.0}};
  const auto axis_y = [&](double time_s) { return snapshot(scene, time_s).solids[0].axis.y(); };
  EXPECT_DOUBLE_EQ(axis_y(0.0), 0.0);
  EXPECT_NEAR(axis_y(0.5), std::sin(0.75), 1e-12);
  EXPECT_NEAR(axis_y(2.0), std::sin(1.5), 1e-12);
  EXPECT_NEAR(axis_y(3.5), std::sin(0.75), 1e-12);
  EXPECT_NEAR(axis_y(5.0), 0.0, 1e-12);
  EXPECT_TRUE(last_owner(snapshot(scene, 0.5)).moving);
  EXPECT_FALSE(last_owner(snapshot(scene, 2.0)).moving);
}

}  // namespace
}  // namespace mosbench
