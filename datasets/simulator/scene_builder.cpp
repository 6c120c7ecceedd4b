#include "datasets/simulator/scene_builder.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/trajectory.hpp"

namespace mosbench {

double SceneBuilder::draw(double lowest, double highest) {
  const double value = lowest + (highest - lowest) * uniform(random_word(seed_, drawn_++));
  return std::floor(value * 100.0) / 100.0;
}

double SceneBuilder::ground_m(std::array<double, 2> at_m) const {
  return ground_height_m(scene_.ground, at_m[0], at_m[1]);
}

void SceneBuilder::box(std::array<double, 2> center_m, double floor_m, std::array<double, 3> size_m,
                       double yaw_rad) {
  scene_.structures.push_back(
      {.shape = Shape::kBox,
       .center_m = {center_m[0], center_m[1], ground_m(center_m) + floor_m + size_m[2] / 2.0},
       .size_m = size_m,
       .yaw_rad = yaw_rad});
}

void SceneBuilder::pole(std::array<double, 2> at_m, double diameter_m, double height_m) {
  scene_.structures.push_back({.shape = Shape::kCylinder,
                               .center_m = {at_m[0], at_m[1], ground_m(at_m) + height_m / 2.0},
                               .size_m = {diameter_m, diameter_m, height_m}});
}

void SceneBuilder::hedge(std::array<double, 2> center_m, std::array<double, 3> size_m) {
  box(center_m, 0.0, size_m);
  scene_.structures.back().density = 0.7;
}

void SceneBuilder::tree(std::array<double, 2> at_m) {
  const double trunk_m = draw(2.2, 3.2), crown_m = draw(2.5, 4.5);
  pole(at_m, draw(0.2, 0.45), trunk_m + crown_m / 2.0);
  scene_.structures.push_back(
      {.shape = Shape::kSphere,
       .center_m = {at_m[0], at_m[1], ground_m(at_m) + trunk_m + crown_m / 2.0},
       .size_m = {crown_m, crown_m, crown_m},
       .density = 0.35});
}

void SceneBuilder::room_walls(std::array<double, 2> low_m, std::array<double, 2> high_m,
                              double height_m, double gap_m) {
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

void SceneBuilder::wanderer(MoverKind kind, const std::vector<std::array<double, 2>>& points_m,
                            double speed_m_s, double wait_s, double start_s) {
  Route route{.from_m = points_m.front(), .after = AfterRoute::kReturn, .start_s = start_s};
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    route.legs.push_back({.to_m = points_m[i], .speed_m_s = speed_m_s, .wait_s = wait_s});
  }
  mover(kind, route);
}

void SceneBuilder::mover(MoverKind kind, const Route& route) {
  scene_.movers.push_back({.kind = kind, .route = route});
}

Route rectangle_route(std::array<double, 2> low_m, std::array<double, 2> high_m, bool clockwise,
                      double fraction, double speed_m_s, double wait_s) {
  std::array<std::array<double, 2>, 4> corners = {
      {{low_m[0], low_m[1]}, {high_m[0], low_m[1]}, {high_m[0], high_m[1]}, {low_m[0], high_m[1]}}};
  if (clockwise) std::reverse(corners.begin(), corners.end());
  const double width_m = std::abs(corners[1][0] - corners[0][0]);
  const double depth_m = std::abs(corners[1][1] - corners[0][1]);
  const std::array<double, 4> sides_m = {width_m, depth_m, width_m, depth_m};

  double along_m = fraction * 2.0 * (width_m + depth_m);
  std::size_t side = 0;
  while (side < 3 && along_m >= sides_m[side]) along_m -= sides_m[side++];
  const auto& before = corners[side];
  const auto& behind = corners[(side + 1) % 4];
  const double part = along_m / sides_m[side];
  Route route{.from_m = {before[0] + part * (behind[0] - before[0]),
                         before[1] + part * (behind[1] - before[1])},
              .after = AfterRoute::kRestart};
  for (std::size_t i = 1; i <= 4; ++i) {
    route.legs.push_back(
        {.to_m = corners[(side + i) % 4], .speed_m_s = speed_m_s, .wait_s = i == 1 ? 0.0 : wait_s});
  }
  route.legs.push_back({.to_m = route.from_m, .speed_m_s = speed_m_s, .wait_s = wait_s});
  return route;
}

}  // namespace mosbench
