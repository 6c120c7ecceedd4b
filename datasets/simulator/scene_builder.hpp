#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/trajectory.hpp"

namespace mosbench {

/// Adds the parts of the built-in scenes. Positions that do not matter are drawn from a generator
/// with a fixed seed, so a built-in scene is always the same.
class SceneBuilder {
 public:
  explicit SceneBuilder(Scene& scene, std::uint64_t start) : scene_(scene), seed_(start) {}

  /// Returns a number uniform in [lowest, highest), in whole hundredths. Not to be called twice in
  /// the arguments of one call: compilers differ in which they evaluate first.
  double draw(double lowest, double highest) {
    const double value = lowest + (highest - lowest) * uniform(random_word(seed_, drawn_++));
    return std::floor(value * 100.0) / 100.0;
  }

  void box(std::array<double, 2> center_m, double floor_m, std::array<double, 3> size_m,
           double yaw_rad = 0.0) {
    scene_.structures.push_back(
        {.shape = Shape::kBox,
         .center_m = {center_m[0], center_m[1], ground_m(center_m) + floor_m + size_m[2] / 2.0},
         .size_m = size_m,
         .yaw_rad = yaw_rad});
  }

  void pole(std::array<double, 2> at_m, double diameter_m, double height_m) {
    scene_.structures.push_back({.shape = Shape::kCylinder,
                                 .center_m = {at_m[0], at_m[1], ground_m(at_m) + height_m / 2.0},
                                 .size_m = {diameter_m, diameter_m, height_m}});
  }

  void hedge(std::array<double, 2> center_m, std::array<double, 3> size_m) {
    box(center_m, 0.0, size_m);
    scene_.structures.back().density = 0.7;
  }

  /// Adds a trunk and a crown that lets part of the rays through.
  void tree(std::array<double, 2> at_m) {
    const double trunk_m = draw(2.2, 3.2), crown_m = draw(2.5, 4.5);
    pole(at_m, draw(0.2, 0.45), trunk_m + crown_m / 2.0);
    scene_.structures.push_back(
        {.shape = Shape::kSphere,
         .center_m = {at_m[0], at_m[1], ground_m(at_m) + trunk_m + crown_m / 2.0},
         .size_m = {crown_m, crown_m, crown_m},
         .density = 0.35});
  }

  /// Adds the four walls of a rectangle, with a gap of `gap_m` in the middle of the one at low y.
  void room_walls(std::array<double, 2> low_m, std::array<double, 2> high_m, double height_m,
                  double gap_m) {
    constexpr double kThick_m = 0.2;
    const double width_m = high_m[0] - low_m[0], depth_m = high_m[1] - low_m[1];
    const double middle_x = (low_m[0] + high_m[0]) / 2.0, middle_y = (low_m[1] + high_m[1]) / 2.0;
    box({low_m[0], middle_y}, 0.0, {kThick_m, depth_m, height_m});
    box({high_m[0], middle_y}, 0.0, {kThick_m, depth_m, height_m});
    box({middle_x, high_m[1]}, 0.0, {width_m, kThick_m, height_m});
    const double side_m = (width_m - gap_m) / 2.0;
    box({low_m[0] + side_m / 2.0, low_m[1]}, 0.0, {side_m, kThick_m, height_m});
    box({high_m[0] - side_m / 2.0, low_m[1]}, 0.0, {side_m, kThick_m, height_m});
  }

  /// Adds somebody who walks between points at `speed_m_s`, back and forth, standing `wait_s`
  /// before each leg.
  void wanderer(MoverKind kind, const std::vector<std::array<double, 2>>& points_m,
                double speed_m_s, double wait_s, double start_s = 0.0) {
    Route route{.from_m = points_m.front(), .after = AfterRoute::kReturn, .start_s = start_s};
    for (std::size_t i = 1; i < points_m.size(); ++i) {
      route.legs.push_back({.to_m = points_m[i], .speed_m_s = speed_m_s, .wait_s = wait_s});
    }
    mover(kind, route);
  }

  void mover(MoverKind kind, const Route& route) {
    scene_.movers.push_back({.kind = kind, .route = route});
  }

 private:
  double ground_m(std::array<double, 2> at_m) const {
    return ground_height_m(scene_.ground, at_m[0], at_m[1]);
  }

  Scene& scene_;
  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
};

/// Returns a scene on level ground that is empty otherwise.
inline Scene named(std::string_view name, const Ego& ego) {
  Scene scene;
  scene.name = name;
  scene.ego = ego;
  scene.ground = {GroundPlane{}};
  return scene;
}

/// A built-in scene in a file of its own.
Scene road_scene();

}  // namespace mosbench
