#include "datasets/sequence/still_sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/odometry_scenes.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Scans of a scene from places along x, with what else is there in scan k.
class SceneDrive : public Sequence {
 public:
  using At = std::function<double(std::size_t)>;
  using Movers = std::function<std::vector<SceneBox>(std::size_t)>;
  SceneDrive(std::size_t scans, std::vector<SceneBox> scene, At x_m, Movers movers = {})
      : scene_(std::move(scene)), x_m_(std::move(x_m)), movers_(std::move(movers)) {
    for (std::size_t k = 0; k < scans; ++k) {
      mutable_recording().scans.emplace_back().stem = std::to_string(k);
    }
  }
  using Sequence::read;
  void read(std::size_t k, Frame& frame) const override {
    describe(k, frame);
    std::vector<SceneBox> boxes = scene_;
    if (movers_) {
      for (const SceneBox& box : movers_(k)) boxes.push_back(box);
    }
    const Pose pose = mosbench::pose_at({x_m_(k), 0.0, 0.0}, 0.0);
    frame.points = scene_scan(boxes, pose, {.seed = 7, .rings = 24, .columns = 180}).points;
  }

 private:
  std::vector<SceneBox> scene_;
  At x_m_;
  Movers movers_;
};

double stands_at_zero(std::size_t /*k*/) { return 0.0; }

/// Buses of 12 m, two lanes of them on one side, which hide half of the view.
std::vector<SceneBox> crossing_buses(std::size_t k) {
  std::vector<SceneBox> buses;
  for (int i = -6; i < 6; ++i) {
    const double along_m = 14.0 * i + 0.9 * static_cast<double>(k);
    buses.push_back({{along_m, 3.0, -1.8}, {along_m + 12.0, 5.5, 1.4}});
    buses.push_back({{-along_m, 2.0, -1.8}, {12.0 - along_m, 2.8, 1.4}});
  }
  return buses;
}

TEST(StillSensor, IsFoundAlsoWhereBusesFillHalfOfTheView) {
  const StillSensor alone = find_still_sensor(SceneDrive(20, street(), stands_at_zero));
  EXPECT_TRUE(alone.stands) << alone.said;
  EXPECT_THAT(alone.said, testing::MatchesRegex("no poses: scan matching finds the sensor standing "
                                                "still \\(.* cm, 0.0. degrees over 20 scans\\), "
                                                "taken as static"));
  const SceneDrive crossed(40, street(), stands_at_zero, crossing_buses);
  const StillSensor behind = find_still_sensor(crossed);
  EXPECT_TRUE(behind.stands) << behind.said;
}

TEST(StillSensor, IsNoneThatMovesSlowlyOrAtTheEndOnly) {
  for (const double step_m : {0.005, 0.02, 0.1, 1.0}) {
    const auto drives = [=](std::size_t k) { return step_m * static_cast<double>(k); };
    EXPECT_FALSE(find_still_sensor(SceneDrive(60, street(), drives)).stands) << step_m;
    EXPECT_FALSE(find_still_sensor(SceneDrive(60, street(), drives, crossing_buses)).stands)
        << step_m;
  }
  const auto at_a_light = [](std::size_t k) { return k < 197 ? 0.0 : 0.1 * double(k - 196); };
  const StillSensor waited = find_still_sensor(SceneDrive(200, street(), at_a_light));
  EXPECT_FALSE(waited.stands);
  EXPECT_EQ(waited.said, "");
  // It moved in the middle, and came back.
  const auto and_back = [](std::size_t k) { return k > 20 && k < 30 ? 0.3 : 0.0; };
  EXPECT_FALSE(find_still_sensor(SceneDrive(60, street(), and_back)).stands);
}

TEST(StillSensor, CannotBeToldWhereNothingHoldsTheScansAlongOneDirection) {
  for (const auto& scene : {corridor(), field()}) {
    for (const double step_m : {0.0, 0.3}) {
      const auto drives = [=](std::size_t k) { return step_m * static_cast<double>(k); };
      const StillSensor found = find_still_sensor(SceneDrive(20, scene, drives));
      EXPECT_FALSE(found.stands) << step_m;
    }
  }
  EXPECT_THAT(find_still_sensor(SceneDrive(20, corridor(), stands_at_zero)).said,
              testing::AllOf(HasSubstr("scan matching cannot tell whether the sensor stands still"),
                             testing::ContainsRegex("it has scan .* moved by [0-9]+ cm and 0\\.. "
                                                    "degrees, known to [0-9]+ cm and "),
                             HasSubstr(" degrees (poses static if it stands)")));
  // One scan of another place says that it moves, also where the others say nothing.
  const SceneDrive through(20, {}, stands_at_zero,
                           [](std::size_t k) { return k == 10 ? street() : corridor(); });
  EXPECT_FALSE(find_still_sensor(through).stands);
  EXPECT_EQ(find_still_sensor(through).said, "");
}

TEST(StillSensor, IsNotLookedForInFewScansOrWithoutPoints) {
  EXPECT_FALSE(find_still_sensor(SceneDrive(9, street(), stands_at_zero)).stands);
  EXPECT_FALSE(find_still_sensor(SceneDrive(20, {}, stands_at_zero)).stands);
  EXPECT_FALSE(find_still_sensor(SceneDrive(0, {}, stands_at_zero)).stands);
}

}  // namespace
}  // namespace mosbench
