#include "eval/breakdown/error_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "datasets/simulator/simulator.hpp"

namespace mosbench {
namespace {

/// Owners in the scans of `world`.
enum : std::uint32_t { kRoad, kCar, kHedge, kPole, kWall };

Scene world() {
  Scene scene;
  scene.ground = {GroundPlane{}};
  scene.ego.carrier = Carrier::kTripod;
  scene.ego.sensor_height_m = 1.7;
  scene.structures = {
      {.center_m = {10.0, -6.0, 0.75}, .size_m = {4.4, 1.8, 1.5}},
      {.center_m = {10.0, 6.0, 1.5}, .size_m = {4.0, 4.0, 3.0}, .density = 0.3},
      {.shape = Shape::kCylinder, .center_m = {8.0, 0.0, 2.5}, .size_m = {0.06, 0.06, 5.0}},
      {.center_m = {25.0, 0.0, 3.0}, .size_m = {0.2, 40.0, 6.0}}};
  return scene;
}

SimulatedScan scan_of(const Scene& scene) {
  return Simulator(scene, sensor_model(SensorKind::kHdl64e), 1).scan(0);
}

Frame frame_of(const SimulatedScan& scan) {
  Frame frame;
  frame.points = scan.points;
  frame.map_from_sensor = scan.map_from_sensor;
  return frame;
}

class ErrorScenes : public testing::Test {
 protected:
  ErrorScenes() {
    judged_.frame = frame_of(scan_);
    judged_.outcomes.assign(scan_.points.size(), PointOutcome::kTrueNegative);
  }

  void set(std::uint32_t owner, PointOutcome outcome) {
    for (std::size_t i = 0; i < scan_.owners.size(); ++i) {
      if (scan_.owners[i] == owner) judged_.outcomes[i] = outcome;
    }
  }
  /// Returns the scene that most wrong points of an owner have, of the judged scan.
  ErrorScene most_of(std::uint32_t owner, const Frame* earlier,
                     std::span<const std::uint32_t> classes = {}) const {
    const std::vector<ErrorScene> scenes = error_scenes(judged_, earlier, classes);
    std::map<ErrorScene, std::size_t> counts;
    std::size_t points = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      if (scan_.owners[i] != owner) continue;
      ++points;
      ++counts[scenes[i]];
    }
    for (const auto& [scene, count] : counts) {
      if (2 * count > points) return scene;
    }
    return ErrorScene::kNone;
  }
  /// The same where the owner's points alone are false.
  ErrorScene of_false(std::uint32_t owner) {
    set(owner, PointOutcome::kFalsePositive);
    const ErrorScene scene = most_of(owner, &judged_.frame);
    set(owner, PointOutcome::kTrueNegative);
    return scene;
  }

  SimulatedScan scan_ = scan_of(world());
  JudgedScan judged_;
};

TEST_F(ErrorScenes, AreToldByTheShapeOfWhatStandsThere) {
  EXPECT_EQ(of_false(kRoad), ErrorScene::kGround);
  EXPECT_EQ(of_false(kCar), ErrorScene::kParked);
  EXPECT_EQ(of_false(kHedge), ErrorScene::kVegetation);
  EXPECT_EQ(of_false(kPole), ErrorScene::kEdge);
  EXPECT_EQ(of_false(kWall), ErrorScene::kElse);
  for (const ErrorScene scene : error_scenes(judged_, nullptr)) {
    ASSERT_EQ(scene, ErrorScene::kNone) << "nothing is wrong";
  }
}

TEST_F(ErrorScenes, OfAWallAreEdgesBesideWhatStandsBeforeIt) {
  set(kWall, PointOutcome::kFalsePositive);
  const std::vector<ErrorScene> scenes = error_scenes(judged_, &judged_.frame);
  std::size_t beside = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (scan_.owners[i] != kWall || judged_.frame.points[i].z < -1.0F) continue;
    // The pole hides half a degree of it.
    if (std::abs(judged_.frame.points[i].y) >= 0.3F) continue;
    EXPECT_EQ(scenes[i], ErrorScene::kEdge) << judged_.frame.points[i].y;
    ++beside;
  }
  EXPECT_GT(beside, 0U);
}

TEST_F(ErrorScenes, OfWhatWasHiddenASecondBeforeAreFirstSight) {
  set(kCar, PointOutcome::kFalsePositive);
  set(kHedge, PointOutcome::kFalseNegative);
  Scene hidden = world();
  hidden.structures.push_back({.center_m = {5.0, -3.0, 2.0}, .size_m = {0.2, 4.0, 4.0}});
  const Frame earlier = frame_of(scan_of(hidden));
  EXPECT_EQ(most_of(kCar, &earlier), ErrorScene::kFirstSight);
  EXPECT_NE(most_of(kHedge, &earlier), ErrorScene::kFirstSight);
  EXPECT_NE(most_of(kHedge, &earlier), ErrorScene::kVegetation) << "what moves is no plant";
  EXPECT_EQ(most_of(kHedge, nullptr), ErrorScene::kFirstSight) << "nothing was seen before";
}

TEST_F(ErrorScenes, OfScansWhoseSurfacesPosesPutApartAreOfPoses) {
  set(kWall, PointOutcome::kFalsePositive);
  for (const int axis : {0, 2}) {
    Frame earlier = judged_.frame;
    earlier.map_from_sensor.translation()[axis] += 0.01;
    EXPECT_EQ(most_of(kWall, &earlier), ErrorScene::kElse) << axis;
    earlier.map_from_sensor.translation()[axis] += 0.1;
    EXPECT_EQ(most_of(kWall, &earlier), ErrorScene::kPose) << axis;
  }
}

TEST_F(ErrorScenes, OfFalsePointsHalfAMetreFromWhatMovesAreNearIt) {
  set(kRoad, PointOutcome::kFalsePositive);
  set(kCar, PointOutcome::kTruePositive);
  const std::vector<ErrorScene> scenes = error_scenes(judged_, &judged_.frame);
  std::size_t near = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (scan_.owners[i] != kRoad) continue;
    double nearest_m = 1e9;
    for (std::size_t j = 0; j < scenes.size(); ++j) {
      if (scan_.owners[j] != kCar) continue;
      const auto& a = judged_.frame.points[i];
      const auto& b = judged_.frame.points[j];
      nearest_m =
          std::min(nearest_m, std::hypot(double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z));
    }
    const auto expected = nearest_m <= 0.5 ? ErrorScene::kNearMoving : ErrorScene::kGround;
    near += nearest_m <= 0.5 ? 1U : 0U;
    ASSERT_EQ(scenes[i], expected) << nearest_m;
    i += 150;  // comparing all would take long
  }
  EXPECT_GT(near, 0U);
  set(kCar, PointOutcome::kFalseNegative);
  EXPECT_NE(most_of(kCar, &judged_.frame), ErrorScene::kNearMoving) << "missed points are it";
}

TEST_F(ErrorScenes, OfPointsWithoutAPlaceAreElse) {
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  judged_.frame.points = {{not_a_number, 0, 0, 0}, {1e30F, 1e30F, 0, 0}, {0, 0, 0, 0}};
  judged_.outcomes.assign(3, PointOutcome::kFalsePositive);
  EXPECT_EQ(error_scenes(judged_, &judged_.frame), std::vector<ErrorScene>(3, ErrorScene::kElse));
}

TEST_F(ErrorScenes, OfClassesWinOverShapesButNotOverSight) {
  set(kWall, PointOutcome::kFalsePositive);
  for (const auto& [id, scene] : {std::pair{40U, ErrorScene::kGround},
                                  {10U, ErrorScene::kParked},
                                  {70U, ErrorScene::kVegetation},
                                  {80U, ErrorScene::kEdge},
                                  {50U, ErrorScene::kElse}}) {
    const std::vector<std::uint32_t> classes(scan_.points.size(), 7U << 16U | id);
    EXPECT_EQ(most_of(kWall, &judged_.frame, classes), scene) << id;
    EXPECT_EQ(most_of(kWall, nullptr, classes), ErrorScene::kFirstSight) << id;
  }
}

}  // namespace
}  // namespace mosbench
