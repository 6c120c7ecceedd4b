#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "tests/odometry_scenes.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class EveryOdometry : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryOdometry, testing::Values("simple", "kiss"));

std::vector<ScanPose> drive(Odometry& odometry, const std::vector<SceneBox>& scene, int scans,
                            const Eigen::Vector3d& step_m) {
  std::vector<ScanPose> poses;
  for (int k = 0; k < scans; ++k) {
    poses.push_back(odometry.push(scene_points(scene, pose_at(k * step_m, 0), k)));
  }
  return poses;
}

TEST_P(EveryOdometry, FollowsADriveThroughAStreet) {
  const auto odometry = make_odometry(GetParam());
  for (int k = 0; k < 15; ++k) {
    // Speeds up to 8 m/s.
    const double x = k < 8 ? 0.05 * k * k : 3.2 + 0.8 * (k - 8);
    const Pose truth = pose_at({x, 0.01 * k * k, 0}, 0.01 * k);
    const std::vector<Point> points = scene_points(street(), truth, k);
    ASSERT_GT(points.size(), 5000u);
    const ScanPose pose = odometry->push(points);
    EXPECT_EQ(pose.doubt, "") << k;
    EXPECT_LT((pose.map_from_sensor.translation() - truth.translation()).norm(), 0.12) << k;
    EXPECT_TRUE(is_finite(pose));
    if (k == 0) continue;
    EXPECT_GT(pose.overlap, 0.8);
    EXPECT_GT(pose.geometry, 0.03);
  }
}

TEST_P(EveryOdometry, DoubtsPosesInACorridorAndNamesTheDirection) {
  const auto odometry = make_odometry(GetParam());
  const std::vector<ScanPose> poses = drive(*odometry, corridor(), 4, {0.3, 0, 0});
  for (std::size_t k = 1; k < poses.size(); ++k) {
    EXPECT_TRUE(is_finite(poses[k]));
    EXPECT_THAT(poses[k].doubt, HasSubstr("motion along"));
    EXPECT_GT(poses[k].covariance(3, 3), 20 * poses[k].covariance(4, 4));
  }
}

TEST_P(EveryOdometry, DoubtsPosesInAnEmptyField) {
  const auto odometry = make_odometry(GetParam());
  for (const ScanPose& pose : drive(*odometry, field(), 4, {0.3, 0, 0})) {
    EXPECT_TRUE(is_finite(pose));
    if (pose.overlap == 0) continue;  // the first
    EXPECT_THAT(pose.doubt, HasSubstr("its surfaces hardly constrain"));
  }
}

TEST(Kiss, DoubtsThatItHardlyMovesOverFlatGroundThatEqualBeamsDrawTheirRingsOn) {
  const auto odometry = make_odometry("kiss");
  std::vector<SceneBox> scene = field();
  for (int i = -4; i < 8; ++i) scene.push_back({{20.0 * i, 7, -2}, {20.0 * i + 0.4, 7.4, 2}});
  for (int i = -4; i < 8; ++i) scene.push_back({{17.0 * i, -9, -2}, {17.0 * i + 4, -8.6, 0}});
  int wrong = 0, doubted = 0;
  Pose before = Pose::Identity();
  for (int k = 0; k < 12; ++k) {
    const SceneScan scan = scene_scan(scene, pose_at({1.5 * k, 0, 0}, 0), {.jitter_rad = 0});
    const ScanPose pose = odometry->push(scan.points);
    const double moved_m = (before.inverse() * pose.map_from_sensor).translation().x();
    before = pose.map_from_sensor;
    if (k == 0 || moved_m > 1) continue;
    ++wrong;
    doubted += pose.doubtful() ? 1 : 0;
    EXPECT_TRUE(is_finite(pose));
  }
  EXPECT_GE(wrong, 8);  // KISS-ICP does so
  EXPECT_GE(doubted, wrong - 2);
}

TEST_P(EveryOdometry, KeepsConstantVelocityOverScansWithoutPoints) {
  const auto odometry = make_odometry(GetParam());
  drive(*odometry, street(), 6, {0.5, 0, 0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const ScanPose empty = odometry->push({});
  const ScanPose broken = odometry->push(std::vector<Point>(500, Point{nan, nan, nan, nan}));
  EXPECT_NEAR(empty.map_from_sensor.translation().x(), 3.0, 0.1);
  EXPECT_NEAR(broken.map_from_sensor.translation().x(), 3.5, 0.1);
  EXPECT_THAT(empty.doubt, HasSubstr("only 0 points"));
  EXPECT_THAT(broken.doubt, HasSubstr("only 0 points"));
  const ScanPose back = odometry->push(scene_points(street(), pose_at({4.0, 0, 0}, 0), 8));
  EXPECT_EQ(back.doubt, "");
  EXPECT_NEAR(back.map_from_sensor.translation().x(), 4.0, 0.1);
}

TEST_P(EveryOdometry, LeavesOutPointsThatMove) {
  // A wall that drives ahead of the sensor, and a second odometry that never sees it.
  const auto all = make_odometry(GetParam()), without = make_odometry(GetParam()),
             left_out = make_odometry(GetParam());
  double worst_m = 0;
  for (int k = 0; k < 12; ++k) {
    const Pose truth = pose_at({0.6 * k, 0, 0}, 0);
    const std::vector<Point> street_points = scene_points(street(), truth, k);
    std::vector<Point> points = street_points;
    for (int i = 0; i < 2000; ++i) {
      points.push_back({6.0F, -4.0F + 0.1F * static_cast<float>(i % 80),
                        -1.7F + 0.1F * static_cast<float>(i / 80), 0});
    }
    std::vector<std::uint8_t> moving(street_points.size(), 0);
    moving.resize(points.size(), 1);
    all->push(points);
    without->push(street_points);
    const ScanPose pose = left_out->push(points);
    left_out->leave_out(moving);
    worst_m = std::max(worst_m, (pose.map_from_sensor.translation() - truth.translation()).norm());
  }
  EXPECT_LT(worst_m, 0.15);
  all->push({});
  without->push({});
  left_out->push({});
  EXPECT_EQ(left_out->map_points() == all->map_points(), false);
  EXPECT_NEAR(static_cast<double>(left_out->map_points()),
              static_cast<double>(without->map_points()),
              0.02 * static_cast<double>(without->map_points()));
  EXPECT_THROW(left_out->leave_out(std::vector<std::uint8_t>(3, 1)), std::invalid_argument);
}

TEST_P(EveryOdometry, IsNotChangedByLeavingOutNothing) {
  const auto plain = make_odometry(GetParam()), asked = make_odometry(GetParam());
  for (int k = 0; k < 4; ++k) {
    const std::vector<Point> points = scene_points(street(), pose_at({0.5 * k, 0, 0}, 0), k);
    const Pose expected = plain->push(points).map_from_sensor;
    EXPECT_EQ(asked->push(points).map_from_sensor.matrix(), expected.matrix());
    asked->leave_out(std::vector<std::uint8_t>(points.size(), 0));
  }
  EXPECT_EQ(plain->map_points(), asked->map_points());
}

TEST_P(EveryOdometry, StaysAtTheStartWhenRangeLimitsLeaveNothing) {
  const auto odometry = make_odometry(GetParam(), {{"min_range_m", 900.0}, {"max_range_m", 901.0}});
  for (const ScanPose& pose : drive(*odometry, street(), 3, {1, 0, 0})) {
    EXPECT_TRUE(pose.map_from_sensor.isApprox(Pose::Identity()));
    EXPECT_THAT(pose.doubt, HasSubstr("only 0 points between min_range_m and max_range_m"));
  }
  EXPECT_EQ(odometry->map_points(), 0u);
}

TEST_P(EveryOdometry, StartsAtTheFirstScanThatHasPoints) {
  const auto odometry = make_odometry(GetParam());
  EXPECT_TRUE(odometry->push({}).doubtful());
  EXPECT_THAT(odometry->push(scene_points(street(), Pose::Identity(), 1)).doubt,
              HasSubstr("no scan before it could be used"));
  EXPECT_EQ(odometry->push(scene_points(street(), pose_at({0.1, 0, 0}, 0), 2)).doubt, "");
}

TEST_P(EveryOdometry, DoubtsAJumpToAnotherPlace) {
  const auto odometry = make_odometry(GetParam());
  drive(*odometry, street(), 5, {0.2, 0, 0});
  const ScanPose far = odometry->push(scene_points(street(), pose_at({400, 300, 0}, 1), 5));
  EXPECT_TRUE(is_finite(far));
  const ScanPose jump = odometry->push(scene_points(street(), pose_at({2.2, 0, 0}, 0), 6));
  EXPECT_TRUE(jump.doubtful() || far.doubtful());
}

TEST_P(EveryOdometry, PredictsFartherOverAGapAndSaysSo) {
  const auto odometry = make_odometry(GetParam());
  std::int64_t stamp_ns = 0;
  for (int k = 0; k < 6; ++k, stamp_ns += 100'000'000) {
    odometry->push(scene_points(street(), pose_at({0.5 * k, 0, 0}, 0), k), {stamp_ns});
  }
  const ScanPose pose =
      odometry->push(scene_points(street(), pose_at({4.5, 0, 0}, 0), 6), {stamp_ns + 300'000'000});
  EXPECT_NEAR(pose.map_from_sensor.translation().x(), 4.5, 0.1);
  EXPECT_THAT(pose.doubt, HasSubstr("after the scan before"));
  EXPECT_THAT(odometry->push({}, {stamp_ns}).doubt, HasSubstr("its stamp is not after"));
}

/// The largest error of positions along x, metres, when scan k is at `x_m(k)` and moves to `x_m(k +
/// 1)`.
template <typename Position>
double error_with_deskew(const char* kind, const char* deskew, Position&& x_m) {
  const auto odometry = make_odometry(kind, {{"deskew", std::string(deskew)}});
  double error_m = 0;
  for (int k = 0; k < 10; ++k) {
    const Eigen::Vector3d motion_m(x_m(k + 1) - x_m(k), 0, 0);
    const SceneScan scan = scene_scan(street(), pose_at({x_m(k), 0, 0}, 0),
                                      {.motion_m = motion_m, .seed = static_cast<unsigned>(k)});
    const ScanPose pose = odometry->push(scan.points, {std::nullopt, scan.point_times_ns});
    error_m = std::max(error_m, std::abs(pose.map_from_sensor.translation().x() - x_m(k)));
  }
  return error_m;
}

TEST_P(EveryOdometry, CorrectsScansForTheMotionOfTheSensor) {
  const auto speeding_up = [](int k) { return 0.075 * k * k; };
  const double none_m = error_with_deskew(GetParam(), "none", speeding_up);
  const double velocity_m = error_with_deskew(GetParam(), "velocity", speeding_up);
  EXPECT_GT(none_m, 0.15);
  EXPECT_LT(velocity_m, 0.7 * none_m);
  EXPECT_LE(error_with_deskew(GetParam(), "poses", speeding_up), velocity_m + 0.01);
}

TEST_P(EveryOdometry, CorrectsTheFirstScanAsWell) {
  const auto driving = [](int k) { return 0.8 * k; };
  // Half a motion, 0.4 m, when the first scan stays skewed.
  EXPECT_LT(error_with_deskew(GetParam(), "velocity", driving), 0.2);
  EXPECT_LT(error_with_deskew(GetParam(), "poses", driving), 0.2);
}

TEST_P(EveryOdometry, RefusesTimesThatAreNotOnePerPoint) {
  const auto odometry = make_odometry(GetParam());
  const std::vector<std::int64_t> times_ns = {1, 2, 3};
  EXPECT_THROW(odometry->push({}, {std::nullopt, times_ns}), std::invalid_argument);
}

TEST_P(EveryOdometry, RefusesSettingsThatDoNotGoTogether) {
  EXPECT_THROW(make_odometry(GetParam(), {{"min_range_m", 80.0}, {"max_range_m", 80.0}}),
               std::invalid_argument);
  EXPECT_THROW(make_odometry(GetParam(), {}, 0), std::invalid_argument);
}

TEST(Odometries, AreFoundByName) {
  EXPECT_EQ(odometries().front().name, "simple");
  EXPECT_EQ(find_odometry("kiss")->title, "KISS-ICP");
  EXPECT_EQ(find_odometry("icp"), nullptr);
}

TEST(OdometryPresets, AreThoseOfTheAuthors) {
  EXPECT_EQ(odometry_presets().size(), 6u);
  for (const OdometryPreset& preset : odometry_presets()) {
    Settings settings = find_odometry(preset.odometry)->defaults;
    for (const auto& [key, value] : preset.settings) settings.set(key, value);
    find_odometry(preset.odometry)->check(settings);
    const bool offline = preset.name == "kitti-offline";
    EXPECT_EQ(settings.number("map_radius_m"), offline ? 0.5 : 2.0);
    EXPECT_EQ(settings.number("tolerance"), offline ? 1e-6 : 1e-3);
    EXPECT_EQ(settings.choice("kitti_correction") == "on", preset.name.starts_with("kitti"));
    EXPECT_EQ(settings.number("sigma_m") == 12, preset.name == "uq-vlp16");
  }
}

}  // namespace
}  // namespace mosbench
