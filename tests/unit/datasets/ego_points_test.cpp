#include "datasets/sequence/ego_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Pair;

/// What stands, what is mounted (in the sensor's frame), and what else is there in a scan.
struct EgoScene {
  std::vector<SceneBox> standing, mounted;
  std::function<SceneBox(int k, const Pose& pose)> moving = {};
  double jitter_rad = 0.01;  ///< of beams; without it they draw rings that move with the sensor
};

SceneBox at(const Eigen::Vector3d& position_m, const SceneBox& box) {
  return {position_m + box.low, position_m + box.high};
}

bool is_on(const SceneBox& box, const Point& point) {
  constexpr double kNear_m = 1e-3;
  const Eigen::Array3d p(point.x, point.y, point.z);
  return (p > box.low.array() - kNear_m).all() && (p < box.high.array() + kNear_m).all();
}

/// A drive through a scene whose scans are cast as they are read; the sensor looks along x.
class EgoDrive : public Sequence {
 public:
  /// The poses that are told are off by up to `off_m` along each axis.
  EgoDrive(EgoScene scene, const std::vector<Pose>& poses, double off_m = 0.0)
      : scene_(std::move(scene)), poses_(poses) {
    std::srand(1);
    for (Pose pose : poses) {
      pose.translation() += off_m * Eigen::Vector3d::Random();
      mutable_recording().scans.emplace_back().map_from_sensor = pose;
    }
  }
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    frame.truth.reset();
    const Pose& pose = poses_[scan_index];
    const int k = static_cast<int>(scan_index);
    std::vector<SceneBox> boxes = scene_.standing;
    for (const SceneBox& box : scene_.mounted) boxes.push_back(at(pose.translation(), box));
    if (scene_.moving) boxes.push_back(scene_.moving(k, pose));
    const auto seed = static_cast<unsigned>(k) + 1;
    frame.points = scene_scan(boxes, pose, {.seed = seed, .jitter_rad = scene_.jitter_rad}).points;
  }
  bool is_mounted(const Point& point) const {
    return std::ranges::any_of(scene_.mounted, [&](const auto& box) { return is_on(box, point); });
  }

 private:
  EgoScene scene_;
  std::vector<Pose> poses_;
};

std::vector<Pose> straight(double way_m, int scans = 60) {
  std::vector<Pose> poses;
  for (int k = 0; k < scans; ++k) poses.push_back(pose_at({way_m * k / scans, 0, 0}, 0));
  return poses;
}

/// A hood below the beams that look ahead, and a rack behind.
std::vector<SceneBox> car() {
  return {{{1.2, -0.8, -0.6}, {2.6, 0.8, -0.3}}, {{-1.3, -0.7, -0.5}, {-1.2, 0.7, -0.15}}};
}
std::vector<SceneBox> arm() { return {{{0.5, 0.1, -0.3}, {0.9, 0.2, -0.05}}}; }

/// Expects that mounted points are found, nearly all and hardly others.
void expect_found(const EgoDrive& drive) {
  const EgoPlaces ego = find_ego(drive);
  ASSERT_FALSE(ego.empty());
  std::size_t mounted = 0, missed = 0, others = 0;
  for (std::size_t k = 0; k < drive.size(); k += 7) {
    for (const Point& point : drive.read(k).points) {
      const bool is_mounted = drive.is_mounted(point), is_held = ego.hold(point);
      mounted += is_mounted;
      missed += is_mounted && !is_held;
      others += !is_mounted && is_held;
    }
  }
  EXPECT_GT(mounted, 500U);
  EXPECT_LT(missed, mounted / 50);
  EXPECT_LT(others, mounted / 50);
}

TEST(EgoPoints, OfACarAreFoundAlsoOnALongDriveAndInAStandstill) {
  expect_found(EgoDrive({street(), car()}, straight(60)));
  expect_found(EgoDrive({street(), car()}, straight(15, 20)));
  std::vector<Pose> stops = straight(20, 40);
  stops.insert(stops.begin() + 20, 200, stops[20]);
  expect_found(EgoDrive({street(), car()}, stops));
}

TEST(EgoPoints, OfARobotsArmAreFoundInACorridorWhoseWallsStay) {
  expect_found(EgoDrive({mosbench::corridor(), arm()}, straight(30)));
}

TEST(EgoPoints, AreNoneWhereNothingIsMounted) {
  std::vector<SceneBox> wall = field();
  wall.push_back({{-1e4, 1.2, -2}, {1e4, 2, 3}});
  std::vector<SceneBox> corner = {mosbench::corridor()[0], mosbench::corridor()[1]};
  corner.push_back({{-30, -5, -2}, {25, -1.7, 2}});
  corner.push_back({{-30, 1.9, -2}, {21.4, 30, 2}});
  corner.push_back({{25, -5, -2}, {27, 30, 2}});
  std::vector<Pose> turning = straight(23, 40);
  for (int k = 0; k < 40; ++k) turning.push_back(pose_at({23.2, 0.5 * k, 0}, 1.5707963));
  for (const auto& [standing, poses] : {std::pair{street(), straight(60)},
                                        {street(), straight(15, 20)},
                                        {mosbench::corridor(), straight(30)},
                                        {mosbench::corridor(), straight(100)},
                                        {wall, straight(30)},
                                        {corner, turning}}) {
    const EgoPlaces ego = find_ego(EgoDrive({standing, {}}, poses));
    EXPECT_TRUE(ego.empty()) << to_string(ego);
  }
}

TEST(EgoPoints, AreNoneOfTheGroundThatALowRobotSeesAtAGlance) {
  const std::vector<SceneBox> ground = {{{-1e4, -1e4, -3}, {1e4, 1e4, -0.4}}};
  for (const double off_m : {0.0, 0.03, 0.08}) {
    const EgoPlaces ego = find_ego(EgoDrive({ground, {}, {}, 0.0}, straight(40, 80), off_m));
    EXPECT_TRUE(ego.empty()) << off_m << ": " << to_string(ego);
  }
  expect_found(EgoDrive({mosbench::corridor(), arm()}, straight(30), 0.03));
}

TEST(EgoPoints, AreNoneOfACarThatFollows) {
  const SceneBox behind{{-4.5, -0.9, -1.5}, {-3, 0.9, 0.2}};
  const auto part = [&](int k, const Pose& pose) {
    return at(pose.translation() - Eigen::Vector3d(k < 45 ? 0.0 : 0.5 * (k - 45), 0, 0), behind);
  };
  EXPECT_TRUE(find_ego(EgoDrive({street(), {}, part}, straight(60))).empty());
  const auto swaying = [&](int k, const Pose& pose) {
    return at(pose.translation() - Eigen::Vector3d(0.4 * std::sin(0.7 * k), 0, 0), behind);
  };
  EXPECT_TRUE(find_ego(EgoDrive({street(), {}, swaying}, straight(60))).empty());
}

TEST(EgoPoints, AreNotSaidWhereTheVehicleHardlyMoves) {
  EXPECT_TRUE(find_ego(EgoDrive({street(), car()}, straight(7))).empty());
  EXPECT_TRUE(
      find_ego(EgoDrive({street(), car()}, std::vector<Pose>(30, Pose::Identity()))).empty());
}

TEST(EgoPoints, BecomeMissingReturnsWithoutTruthWhereTheyAreToBeLeftOut) {
  const TempFolder folder;
  const EgoDrive drive({street(), car()}, straight(15, 20));
  for (std::size_t k = 0; k < drive.size(); ++k) {
    const std::vector<Point> points = drive.read(k).points;
    const std::string stem = std::to_string(100000 + k);
    write_bin(folder / ("s/velodyne/" + stem + ".bin"), points);
    write_labels(folder / ("s/labels/" + stem + ".label"),
                 std::vector<std::uint32_t>(points.size(), 251));
  }
  write_poses(folder / "s/poses.txt", poses_of(drive));
  const Dataset plain = open_dataset(folder / "s", {});
  EXPECT_THAT(members_of(plain.sequences[0]->reading()),
              testing::Not(Contains(testing::Key("drop_ego"))));
  const Dataset left = open_dataset(folder / "s", {.reading = {.drop_ego = Drop::kAuto}});
  const Sequence& sequence = *left.sequences[0];
  EXPECT_THAT(members_of(sequence.reading()),
              Contains(Pair("drop_ego", HasSubstr("points per scan of the vehicle itself"))));
  EXPECT_THAT(sequence.remarks(), Contains(HasSubstr("left out: ")));
  const Frame frame = sequence.read(3), stored = plain.sequences[0]->read(3);
  ASSERT_EQ(frame.points.size(), stored.points.size());
  EXPECT_EQ(*frame.truth, sequence.read_truth(3));
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const bool is_left_out = (*frame.truth)[i] == 0;
    EXPECT_EQ(frame.points[i].x, is_left_out ? 0.0F : stored.points[i].x);
  }
  EXPECT_GT(std::ranges::count(*frame.truth, 0U), 100);

  const Dataset unposed =
      open_dataset(folder / "s", {.reading = {.poses = ByOdometry{}, .drop_ego = Drop::kAuto}});
  EXPECT_THAT(unposed.sequences[0]->remarks(),
              Contains(HasSubstr("no points of the vehicle itself are found")));
}

}  // namespace
}  // namespace mosbench
