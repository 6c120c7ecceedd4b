#include <algorithm>

#include "datasets/simulator/scene_builder.hpp"

namespace mosbench {
namespace {

constexpr double kRoad_m = 500.0;
/// Where people cross, so that no car is parked there.
constexpr std::array kCrossings_m = {35.0, 60.0, 85.0};

bool is_free_of_crossings(double x_m) {
  return std::ranges::none_of(kCrossings_m,
                              [x_m](double at_m) { return std::abs(x_m - at_m) <= 4.0; });
}

/// Adds a car whose windows let three in ten rays through, to its seats or to what is behind it.
void park_car(Scene& scene, SceneBuilder& add, std::array<double, 2> at_m) {
  const double x_m = at_m[0], y_m = at_m[1];
  const auto pane = [&](double ahead_m, double left_m, std::array<double, 3> size_m) {
    add.box({x_m + ahead_m, y_m + left_m}, 1.0, size_m);
    scene.structures.back().let_through = 0.3;
  };
  add.box(at_m, 0.2, {4.4, 1.8, 0.8});
  add.box({x_m - 0.3, y_m}, 1.42, {2.2, 1.5, 0.06});
  for (const double left_m : {-0.78, 0.78}) {
    pane(-0.3, left_m, {2.3, 0.02, 0.42});
    for (const double ahead_m : {-1.4, -0.1, 0.8}) {
      add.box({x_m + ahead_m, y_m + left_m}, 1.0, {0.08, 0.06, 0.42});
    }
    for (const double ahead_m : {-0.9, 0.2}) {
      add.box({x_m + ahead_m, y_m + left_m / 2.0}, 0.9, {0.15, 0.45, 0.5});
    }
  }
  for (const double ahead_m : {-1.45, 0.85}) pane(ahead_m, 0.0, {0.02, 1.5, 0.42});
}

/// Adds houses with hedges, trees and posts before them, from x = 0 on.
void add_houses(Scene& scene, SceneBuilder& add, double side) {
  constexpr double kSway_m = 0.02;
  for (double x_m = 0.0; x_m < kRoad_m;) {
    const double width_m = add.draw(10.0, 18.0), depth_m = add.draw(8.0, 12.0);
    const double middle_m = x_m + width_m / 2.0;
    add.box({middle_m, side * (11.5 + depth_m / 2.0)}, 0.0,
            {width_m, depth_m, add.draw(5.0, 11.0)});
    if (add.draw(0.0, 1.0) < 0.4) {
      add.hedge({middle_m, side * 9.5}, {width_m, 0.8, 1.4});
      scene.structures.back().density = 0.5;
      scene.structures.back().sway_m = kSway_m;
    }
    if (add.draw(0.0, 1.0) < 0.5) {
      add.tree({x_m + add.draw(0.0, width_m), side * 8.6});
      scene.structures.back().sway_m = kSway_m;
    }
    add.pole({x_m + add.draw(0.0, width_m), side * 6.1}, 0.08, 2.6);
    x_m += width_m + add.draw(2.0, 7.0);
  }
  for (double x_m = 12.0; x_m < kRoad_m; x_m += 30.0) add.pole({x_m, side * 6.3}, 0.16, 7.0);
}

void add_side(Scene& scene, SceneBuilder& add, double side) {
  add.box({kRoad_m / 2.0, side * 7.4}, 0.0, {kRoad_m, 3.2, 0.12});
  add_houses(scene, add, side);
  for (double x_m = 3.0; x_m < kRoad_m; x_m += add.draw(5.2, 7.5)) {
    const double y_m = side * 4.6 + add.draw(-0.15, 0.15);
    if (add.draw(0.0, 1.0) < 0.4 && is_free_of_crossings(x_m)) park_car(scene, add, {x_m, y_m});
  }
}

/// Adds somebody who goes along the road until `to_m`.
void go(SceneBuilder& add, MoverKind kind, std::array<double, 2> from_m, double to_m,
        double speed_m_s) {
  add.mover(kind,
            {.from_m = from_m, .legs = {{.to_m = {to_m, from_m[1]}, .speed_m_s = speed_m_s}}});
}

}  // namespace

Scene road_scene() {
  constexpr double kLane_m = 1.7;
  Scene scene =
      named("road", {.carrier = Carrier::kCar,
                     .sensor_height_m = 1.75,
                     .route = {.from_m = {0.0, -kLane_m},
                               .legs = {{.to_m = {kRoad_m - 50.0, -kLane_m}, .speed_m_s = 9.0}}}});
  scene.beam_width_rad = 0.003;
  scene.ground_bumps_m = 0.02;
  SceneBuilder add(scene, 6);
  for (const double side : {-1.0, 1.0}) add_side(scene, add, side);
  go(add, MoverKind::kCar, {45.0, -kLane_m}, 600.0, 8.5);
  go(add, MoverKind::kCyclist, {18.0, -2.6}, 600.0, 5.0);
  for (int i = 0; i < 6; ++i) {
    go(add, MoverKind::kCar, {40.0 + 60.0 * i, kLane_m}, -300.0, add.draw(7.0, 11.0));
  }
  for (int i = 0; i < 2; ++i) go(add, MoverKind::kCyclist, {60.0 + 90.0 * i, 2.6}, -300.0, 5.0);
  for (int i = 0; i < 14; ++i) {
    const double x_m = add.draw(5.0, 130.0), y_m = add.draw(6.9, 7.9);
    go(add, MoverKind::kPedestrian, {x_m, i % 2 == 0 ? y_m : -y_m},
       x_m + (i % 3 == 0 ? -120.0 : 120.0), add.draw(0.9, 1.6));
  }
  for (const double x_m : kCrossings_m) {
    add.wanderer(MoverKind::kPedestrian, {{x_m, -7.0}, {x_m, 7.0}}, 1.3, (x_m - 35.0) / 25.0);
  }
  return scene;
}

}  // namespace mosbench
