#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/simulator/scene_builder.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

Scene room() {
  Scene scene = named("room", {.carrier = Carrier::kGroundRobot,
                               .sensor_height_m = 0.8,
                               .route = {.from_m = {-2.0, 0.0},
                                         .legs = {{.to_m = {2.0, 0.0}, .speed_m_s = 0.4}},
                                         .after = AfterRoute::kReturn}});
  SceneBuilder add(scene, 1);
  add.room_walls({-5.0, -4.0}, {5.0, 4.0}, 2.8, 1.2);
  add.box({0.0, -6.5}, 0.0, {12.0, 0.2, 2.8});
  add.box({0.0, 0.0}, 2.8, {12.0, 14.0, 0.2});
  add.box({3.5, 3.2}, 0.0, {1.6, 0.8, 0.75});
  add.pole({-4.0, 3.0}, 0.3, 2.8);
  add.wanderer(MoverKind::kPedestrian, {{-4.0, 1.5}, {4.0, 1.8}}, 1.2, 0.5);
  scene.doors = {{.hinge_m = {-0.6, -4.0}, .width_m = 1.2, .closed_yaw_rad = 0.0}};
  scene.balls = {{.from_m = {4.0, -2.0, 1.2}, .velocity_m_s = {-3.5, 0.5, 3.0}}};
  return scene;
}

void add_mall_interior(SceneBuilder& add) {
  add.room_walls({0.0, 0.0}, {60.0, 26.0}, 5.0, 4.0);
  add.box({30.0, 13.0}, 5.0, {60.0, 26.0, 0.3});
  for (int i = 0; i < 7; ++i) {
    for (const double y_m : {7.0, 19.0}) add.pole({6.0 + 8.0 * i, y_m}, 0.7, 5.0);
  }
  for (int i = 0; i < 5; ++i)
    add.box({10.0 + 10.0 * i, 13.0}, 0.0, {3.0, 2.0, 1.1 + 0.3 * i}, 0.2 * i);
  for (int i = 0; i < 6; ++i) {
    add.box({7.0 + 9.0 * i, 0.6}, 0.0, {0.2, 1.2, 5.0});
    add.box({7.0 + 9.0 * i, 25.4}, 0.0, {0.2, 1.2, 5.0});
  }
  for (int i = 0; i < 8; ++i) add.hedge({4.0 + 7.0 * i, 10.0}, {0.8, 0.8, 1.4});
}

Scene mall() {
  Scene scene =
      named("mall", {.carrier = Carrier::kHandHeld,
                     .sensor_height_m = 1.7,
                     .route = rectangle_route({5.0, 4.5}, {55.0, 21.5}, false, 0.02, 1.1)});
  SceneBuilder add(scene, 2);
  add_mall_interior(add);
  for (int i = 0; i < 12; ++i) {
    const double y_m = add.draw(2.0, 24.0);
    const double from_x_m = add.draw(2.0, 20.0), to_x_m = add.draw(35.0, 58.0);
    const double speed_m_s = add.draw(0.9, 1.6), wait_s = add.draw(0.0, 3.0);
    add.wanderer(MoverKind::kPedestrian, {{from_x_m, y_m}, {to_x_m, y_m}}, speed_m_s, wait_s);
  }
  for (int i = 0; i < 10; ++i) {
    const double x_m = add.draw(3.0, 57.0);
    const double speed_m_s = add.draw(0.8, 1.5), wait_s = add.draw(0.5, 5.0);
    add.wanderer(MoverKind::kPedestrian, {{x_m, 3.0}, {x_m + 0.5, 11.2}, {x_m, 23.0}}, speed_m_s,
                 wait_s);
  }
  for (int i = 0; i < 5; ++i) {
    const double lane_m = add.draw(0.3, 1.2);
    add.mover(MoverKind::kPedestrian,
              rectangle_route({5.0 - lane_m, 4.5 - lane_m}, {55.0 + lane_m, 21.5 + lane_m},
                              i % 2 == 1, 0.05 + 0.04 * i, 1.0 + 0.1 * i, i == 3 ? 2.0 : 0.0));
  }
  for (int i = 0; i < 4; ++i) {
    scene.doors.push_back({.hinge_m = {12.0 + 11.0 * i, i % 2 == 0 ? 25.8 : 0.3},
                           .width_m = 1.2,
                           .closed_yaw_rad = 0.0,
                           .open_yaw_rad = i % 2 == 0 ? -1.5 : 1.5,
                           .period_s = 5.0 + i});
  }
  scene.balls = {{.from_m = {14.0, 16.0, 1.5}, .velocity_m_s = {5.0, 1.0, 4.0}},
                 {.from_m = {45.0, 9.0, 1.5}, .velocity_m_s = {-4.0, 2.0, 4.5}, .period_s = 3.0}};
  return scene;
}

void add_campus_surroundings(SceneBuilder& add) {
  for (int i = 0; i < 5; ++i) {
    add.box({-10.0 + 30.0 * i, -28.0}, -3.0, {22.0, 14.0, 15.0});
    add.box({-10.0 + 30.0 * i, 58.0}, -3.0, {24.0, 14.0, 18.0});
  }
  add.box({-32.0, 15.0}, -3.0, {12.0, 50.0, 14.0});
  add.box({140.0, 15.0}, -3.0, {12.0, 50.0, 14.0});
  add.box({53.0, 15.0}, -2.0, {30.0, 8.0, 9.0}, 0.1);
  for (int i = 0; i < 14; ++i) {
    add.tree({-18.0 + 11.0 * i, -14.0 + add.draw(-1.0, 1.0)});
    add.tree({-18.0 + 11.0 * i, 44.0 + add.draw(-1.0, 1.0)});
    add.pole({-13.0 + 11.0 * i, -9.0}, 0.15, 5.0);
  }
  for (int i = 0; i < 6; ++i) add.hedge({8.0 + 16.0 * i, 6.0}, {7.0, 1.0, 1.2});
  for (int i = 0; i < 10; ++i) add.tree({5.0 + 10.0 * i, 24.0 + add.draw(-2.0, 2.0)});
}

Scene campus() {
  Scene scene =
      named("campus", {.carrier = Carrier::kGroundRobot,
                       .sensor_height_m = 0.7,
                       .route = rectangle_route({0.0, 0.0}, {105.0, 32.0}, false, 0.0, 1.2)});
  scene.ground = {{.slope_x = 0.015, .slope_y = 0.01},
                  {.height_m = -1.5, .slope_x = 0.05, .slope_y = 0.01}};
  SceneBuilder add(scene, 3);
  add_campus_surroundings(add);
  for (int i = 0; i < 16; ++i) {
    const double y_m = i % 2 == 0 ? add.draw(-7.0, -2.0) : add.draw(0.8, 3.5);
    const double x_m = add.draw(2.0, 80.0);
    const double length_m = add.draw(12.0, 30.0);
    const double speed_m_s = add.draw(0.9, 1.6), wait_s = add.draw(0.0, 4.0);
    add.wanderer(MoverKind::kPedestrian, {{x_m, y_m}, {x_m + length_m, y_m + 1.0}}, speed_m_s,
                 wait_s);
  }
  for (int i = 0; i < 8; ++i) {
    const double lane_m = add.draw(1.5, 3.5);
    add.mover(MoverKind::kPedestrian,
              rectangle_route({-lane_m, -lane_m}, {105.0 + lane_m, 32.0 + lane_m}, i % 2 == 1,
                              i % 2 == 1 ? 0.9 - 0.1 * i : 0.03 + 0.12 * i, 1.0 + 0.05 * i));
  }
  for (int i = 0; i < 6; ++i) {
    const double lane_m = 4.0 + 0.6 * i;
    add.mover(MoverKind::kCyclist,
              rectangle_route({-lane_m, -lane_m}, {105.0 + lane_m, 32.0 + lane_m}, i % 2 == 0,
                              0.15 * i, 3.0 + 0.5 * i));
  }
  add.wanderer(MoverKind::kCar, {{20.0, -9.8}, {70.0, -9.8}}, 3.0, 4.0);
  scene.balls = {{.from_m = {14.0, 3.0, 2.0}, .velocity_m_s = {3.0, -4.0, 6.0}, .period_s = 5.0}};
  return scene;
}

// The block that the street runs around, and the middle of its two lanes.
constexpr std::array<double, 2> kStreetLow_m = {0.0, 0.0}, kStreetHigh_m = {220.0, 130.0};

Route around_block(double outside_m, bool clockwise, double fraction, double speed_m_s,
                   double wait_s = 0.0) {
  return rectangle_route({kStreetLow_m[0] - outside_m, kStreetLow_m[1] - outside_m},
                         {kStreetHigh_m[0] + outside_m, kStreetHigh_m[1] + outside_m}, clockwise,
                         fraction, speed_m_s, wait_s);
}

// Houses, trees, poles and parked cars along one side of the block: `outward` is +1 or -1.
void add_street_side(SceneBuilder& add, double y_m, double outward) {
  for (int i = 0; i < 10; ++i) {
    const double x_m = 5.0 + 23.0 * i, depth_m = add.draw(9.0, 14.0);
    add.box({x_m, y_m + outward * (11.0 + depth_m / 2.0)}, 0.0,
            {add.draw(15.0, 21.0), depth_m, add.draw(6.0, 16.0)});
    add.tree({x_m + 10.0, y_m + outward * 8.5});
    add.pole({x_m + 4.0, y_m + outward * 6.2}, 0.18, 7.0);
    if (i % 2 == 0) {
      add.mover(MoverKind::kCar, {.from_m = {x_m, y_m + outward * 5.2}});
    }
  }
}

void add_street_ends(SceneBuilder& add) {
  for (const double x_m : {-20.0, 240.0}) {
    for (int i = 0; i < 6; ++i)
      add.box({x_m, 2.0 + 25.0 * i}, 0.0, {14.0, 20.0, add.draw(6.0, 14.0)});
  }
  for (const double x_m : {14.0, 206.0}) {
    for (int i = 0; i < 4; ++i) {
      add.box({x_m + (x_m < 100.0 ? 4.0 : -4.0), 30.0 + 23.0 * i}, 0.0, {10.0, 18.0, 9.0});
      add.hedge({x_m - (x_m < 100.0 ? 4.0 : -4.0), 30.0 + 23.0 * i}, {1.0, 8.0, 1.3});
    }
  }
}

Scene street() {
  Scene scene = named("street", {.carrier = Carrier::kCar,
                                 .sensor_height_m = 1.9,
                                 .route = around_block(1.75, false, 0.01, 8.0)});
  SceneBuilder add(scene, 4);
  add_street_side(add, kStreetLow_m[1], -1.0);
  add_street_side(add, kStreetHigh_m[1], 1.0);
  add_street_ends(add);
  for (int i = 0; i < 6; ++i) {
    const double ahead = 0.05 + 0.15 * i;
    add.mover(i == 2 ? MoverKind::kTruck : MoverKind::kCar,
              around_block(1.75, false, ahead, i % 2 == 0 ? 8.0 : 8.5, i == 4 ? 3.0 : 0.0));
    add.mover(MoverKind::kCar, around_block(-1.75, true, 1.0 - ahead, 7.0 + 0.4 * i));
  }
  for (int i = 0; i < 5; ++i) {
    add.mover(MoverKind::kCyclist, around_block(3.8, false, 0.025 + 0.19 * i, 4.5 + 0.3 * i));
  }
  for (int i = 0; i < 24; ++i) {
    const bool clockwise = i % 2 == 0;
    const double along = static_cast<double>(i) / 24.0 + 0.02;
    const double lane_m = add.draw(6.8, 7.8);
    const double speed_m_s = add.draw(0.9, 1.7), wait_s = add.draw(0.0, 4.0);
    add.mover(MoverKind::kPedestrian,
              around_block(lane_m, clockwise, clockwise ? 1.0 - along : along, speed_m_s, wait_s));
  }
  for (int i = 0; i < 5; ++i) {
    add.wanderer(MoverKind::kPedestrian, {{25.0 + 45.0 * i, -7.0}, {25.0 + 45.0 * i, 4.0}}, 1.3,
                 6.0);
  }
  scene.doors = {{.hinge_m = {27.0, -10.9}, .width_m = 1.2, .open_yaw_rad = 1.4}};
  return scene;
}

void add_highway_roadside(SceneBuilder& add, double length_m) {
  for (const double y_m : {-14.0, 14.0}) {
    const double outward = y_m > 0.0 ? 1.0 : -1.0;
    for (double x_m = -200.0; x_m < length_m; x_m += 50.0) {
      add.pole({x_m, y_m + outward}, 0.25, 9.0);
      add.box({x_m + 20.0, y_m}, 0.4, {44.0, 0.15, 0.4});
      if (add.draw(0.0, 1.0) < 0.5) {
        add.tree({x_m + add.draw(0.0, 40.0), y_m + outward * add.draw(6.0, 25.0)});
      } else {
        add.box({x_m + 25.0, y_m + outward * 5.0}, 0.0, {45.0, 0.3, add.draw(2.0, 4.0)});
      }
    }
  }
  for (double x_m = -200.0; x_m < length_m; x_m += 25.0) {
    add.box({x_m, 0.0}, 0.0, {24.0, 0.3, 0.9});
  }
  for (double x_m = 100.0; x_m < length_m; x_m += 400.0) {
    add.pole({x_m, -13.0}, 0.5, 7.0);
    add.pole({x_m, 13.0}, 0.5, 7.0);
    add.box({x_m, 0.0}, 5.8, {0.6, 26.0, 1.2});
  }
}

Scene highway() {
  constexpr double kLength_m = 6000.0, kSpeed_m_s = 25.0;
  Scene scene =
      named("highway", {.carrier = Carrier::kCar,
                        .sensor_height_m = 1.9,
                        .route = {.from_m = {0.0, -6.0},
                                  .legs = {{.to_m = {kLength_m, -6.0}, .speed_m_s = kSpeed_m_s}}}});
  SceneBuilder add(scene, 5);
  add_highway_roadside(add, kLength_m + 200.0);
  for (int i = 0; i < 16; ++i) {
    const double lane_m = i % 3 == 0 ? -2.5 : (i % 3 == 1 ? -6.0 : -9.5);
    const double from_m = -120.0 + 40.0 * i + (lane_m == -6.0 ? 25.0 : 0.0);
    const double speed_m_s = lane_m == -2.5 ? 29.0 : (lane_m == -6.0 ? kSpeed_m_s : 22.0);
    add.mover(lane_m == -9.5 ? MoverKind::kTruck : MoverKind::kCar,
              {.from_m = {from_m, lane_m},
               .legs = {{.to_m = {from_m + 8000.0, lane_m}, .speed_m_s = speed_m_s}}});
  }
  for (int i = 0; i < 60; ++i) {
    const double lane_m = i % 2 == 0 ? 3.0 : 7.0;
    const double from_m = 60.0 + 190.0 * i + add.draw(0.0, 60.0);
    add.mover(i % 7 == 3 ? MoverKind::kTruck : MoverKind::kCar,
              {.from_m = {from_m, lane_m},
               .legs = {{.to_m = {from_m - 12000.0, lane_m}, .speed_m_s = add.draw(24.0, 31.0)}}});
  }
  for (int i = 0; i < 12; ++i) {
    add.mover(MoverKind::kCar, {.from_m = {90.0 + 430.0 * i, -12.4}});
  }
  return scene;
}

struct BuiltIn {
  SceneSummary summary;
  Scene (*make)();
};

constexpr std::array<BuiltIn, 6> kBuiltIn = {{
    {{"mall", "indoors, sensor hand-held at a walk, pedestrians, doors, thrown balls"}, mall},
    {{"campus", "slopes and trees, slow ground robot, pedestrians and cyclists"}, campus},
    {{"street", "car at 8 m/s around a block, cars, cyclists, pedestrians, parked cars"}, street},
    {{"road", "car at 9 m/s past parked cars with windows, hedges, kerbs, posts, thin edges"},
     road_scene},
    {{"highway", "car at 25 m/s, traffic seen up to 120 m away"}, highway},
    {{"room", "ten metres with one pedestrian, a door and a ball, for tests"}, room},
}};

}  // namespace

std::vector<SceneSummary> built_in_scenes() {
  std::vector<SceneSummary> summaries;
  for (const BuiltIn& scene : kBuiltIn) summaries.push_back(scene.summary);
  return summaries;
}

Scene built_in_scene(std::string_view name) {
  std::vector<std::string_view> names;
  for (const BuiltIn& scene : kBuiltIn) {
    if (scene.summary.name == name) return scene.make();
    names.push_back(scene.summary.name);
  }
  throw UsageError("scene '" + std::string(name) + "' is not built in, expected one such as '" +
                   std::string(nearest_name(name, names)) + "' or the path of a .json file");
}

}  // namespace mosbench
