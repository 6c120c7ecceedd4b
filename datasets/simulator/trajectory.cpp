#include "datasets/simulator/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

Eigen::Vector2d to_vector(const std::array<double, 2>& point_m) { return {point_m[0], point_m[1]}; }

double length_m(const Eigen::Vector2d& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y()); }

RouteState state_on_first_pass(const Route& route, double time_s) {
  RouteState state;
  state.position_m = to_vector(route.from_m);
  double remaining_s = time_s;
  for (const Leg& leg : route.legs) {
    const Eigen::Vector2d step_m = to_vector(leg.to_m) - state.position_m;
    const double step_length_m = length_m(step_m);
    if (step_length_m > 0.0) state.heading = step_m / step_length_m;
    remaining_s -= leg.wait_s;
    if (remaining_s < 0.0) return state;
    const double duration_s = step_length_m / leg.speed_m_s;
    if (remaining_s < duration_s) {
      const double walked_m = remaining_s * leg.speed_m_s;
      state.position_m += walked_m * state.heading;
      state.travelled_m += walked_m;
      state.speed_m_s = leg.speed_m_s;
      return state;
    }
    remaining_s -= duration_s;
    state.position_m = to_vector(leg.to_m);
    state.travelled_m += step_length_m;
  }
  return state;
}

/// Small periodic deviations of a carrier from its smooth path.
struct Sway {
  double amplitude = 0.0, frequency_hz = 0.0;
  double at(double time_s) const {
    return amplitude * sin_cos(6.283185307179586 * frequency_hz * time_s).sin;
  }
};

struct Gait {
  Sway up_m, side_m, roll_rad, pitch_rad, yaw_rad;
};

Gait gait_of(Carrier carrier) {
  switch (carrier) {
    case Carrier::kTripod:
      return {};
    case Carrier::kHandHeld:
      return {{0.025, 1.8}, {0.03, 0.9}, {0.02, 0.7}, {0.025, 0.53}, {0.09, 0.31}};
    case Carrier::kGroundRobot:
      return {{0.003, 2.3}, {0.0, 1.0}, {0.006, 1.1}, {0.008, 0.9}, {0.01, 0.2}};
    case Carrier::kCar:
      return {{0.01, 1.2}, {0.0, 1.0}, {0.004, 0.8}, {0.006, 1.3}, {0.0, 1.0}};
  }
  return {};
}

Eigen::Matrix3d rotation(SinCos yaw, SinCos pitch, SinCos roll) {
  Eigen::Matrix3d r;
  r << yaw.cos * pitch.cos, yaw.cos * pitch.sin * roll.sin - yaw.sin * roll.cos,
      yaw.cos * pitch.sin * roll.cos + yaw.sin * roll.sin,  //
      yaw.sin * pitch.cos, yaw.sin * pitch.sin * roll.sin + yaw.cos * roll.cos,
      yaw.sin * pitch.sin * roll.cos - yaw.cos * roll.sin,  //
      -pitch.sin, pitch.cos * roll.sin, pitch.cos * roll.cos;
  return r;
}

/// Returns the mean over two seconds, of a car three: nobody changes direction instantly.
RouteState smoothed_state(const Ego& ego, double time_s) {
  constexpr int kHalfSamples = 16;
  const double sample_step_s = (ego.carrier == Carrier::kCar ? 1.5 : 1.0) / kHalfSamples;
  const Route& route = ego.route;
  const RouteState middle = route_state(route, time_s);
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  for (int i = -kHalfSamples; i <= kHalfSamples; ++i) {
    const RouteState sample = route_state(route, time_s + sample_step_s * i);
    position_m += sample.position_m;
    heading += sample.heading;
  }
  RouteState smooth = middle;
  smooth.position_m = position_m / (2.0 * kHalfSamples + 1.0);
  const double norm = length_m(heading);
  // A turn on the spot has no mean direction.
  if (norm > 1.0) smooth.heading = heading / norm;
  return smooth;
}

}  // namespace

double route_duration_s(const Route& route) {
  double duration_s = 0.0;
  Eigen::Vector2d at_m = to_vector(route.from_m);
  for (const Leg& leg : route.legs) {
    duration_s += leg.wait_s + length_m(to_vector(leg.to_m) - at_m) / leg.speed_m_s;
    at_m = to_vector(leg.to_m);
  }
  return duration_s;
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

RouteState route_state(const Route& route, double time_s) {
  const double elapsed_s = std::max(0.0, time_s - route.start_s);
  if (time_s < route.start_s || route.after == AfterRoute::kStay) {
    RouteState state = state_on_first_pass(route, elapsed_s);
    if (time_s < route.start_s) state.speed_m_s = 0.0;
    return state;
  }
  const double duration_s = route_duration_s(route);
  if (route.after == AfterRoute::kRestart) {
    return state_on_first_pass(route, std::fmod(elapsed_s, duration_s));
  }
  const double phase_s = std::fmod(elapsed_s, 2.0 * duration_s);
  if (phase_s < duration_s) return state_on_first_pass(route, phase_s);
  RouteState state = state_on_first_pass(route, 2.0 * duration_s - phase_s);
  state.heading = -state.heading;
  return state;
}

double ground_height_m(std::span<const GroundPlane> ground, double x_m, double y_m) {
  if (ground.empty()) return 0.0;
  double highest_m = -1e300;
  for (const GroundPlane& plane : ground) {
    highest_m = std::max(highest_m, plane.height_m + plane.slope_x * x_m + plane.slope_y * y_m);
  }
  return highest_m;
}

Pose ego_pose(const Scene& scene, double time_s) {
  const RouteState state = smoothed_state(scene.ego, time_s);
  const Gait gait = gait_of(scene.ego.carrier);
  const SinCos sway = sin_cos(gait.yaw_rad.at(time_s));
  const SinCos yaw{state.heading.y() * sway.cos + state.heading.x() * sway.sin,
                   state.heading.x() * sway.cos - state.heading.y() * sway.sin};
  const double side_m = gait.side_m.at(time_s);
  const double x_m = state.position_m.x() - state.heading.y() * side_m;
  const double y_m = state.position_m.y() + state.heading.x() * side_m;
  Pose pose = Pose::Identity();
  pose.linear() =
      rotation(yaw, sin_cos(gait.pitch_rad.at(time_s)), sin_cos(gait.roll_rad.at(time_s)));
  pose.translation() = Eigen::Vector3d(
      x_m, y_m,
      ground_height_m(scene.ground, x_m, y_m) + scene.ego.sensor_height_m + gait.up_m.at(time_s));
  return pose;
}

}  // namespace mosbench
