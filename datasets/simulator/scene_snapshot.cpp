#include <algorithm>
#include <cmath>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/scene_cast.hpp"
#include "datasets/simulator/trajectory.hpp"

namespace mosbench {
namespace {

/// The speeds above which data sets of the field label an object as moving.
constexpr double kMovingSpeed_m_s = 0.5;
constexpr double kMovingVehicleSpeed_m_s = 1.0;

Eigen::Vector3d to_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// Collects the bodies of one owner, placed by its position on the ground and its heading.
class Builder {
 public:
  Builder(SceneSnapshot& snapshot, const Eigen::Vector3d& base_m, const Eigen::Vector2d& axis)
      : snapshot_(snapshot),
        base_m_(base_m),
        axis_(axis),
        owner_(static_cast<std::uint32_t>(snapshot.owners.size())) {}

  void box(const Eigen::Vector3d& offset_m, const Eigen::Vector3d& size_m) {
    add(Shape::kBox, offset_m, size_m / 2.0);
  }
  void cylinder(const Eigen::Vector3d& offset_m, double radius_m, double height_m) {
    add(Shape::kCylinder, offset_m, {radius_m, radius_m, height_m / 2.0});
  }
  void sphere(const Eigen::Vector3d& offset_m, double radius_m) {
    add(Shape::kSphere, offset_m, {radius_m, radius_m, radius_m});
  }

 private:
  void add(Shape shape, const Eigen::Vector3d& offset_m, const Eigen::Vector3d& half_size_m) {
    const Eigen::Vector3d center_m(
        base_m_.x() + offset_m.x() * axis_.x() - offset_m.y() * axis_.y(),
        base_m_.y() + offset_m.x() * axis_.y() + offset_m.y() * axis_.x(),
        base_m_.z() + offset_m.z());
    snapshot_.solids.push_back({.shape = shape,
                                .center_m = center_m,
                                .half_size_m = half_size_m,
                                .axis = axis_,
                                .owner = owner_});
  }

  SceneSnapshot& snapshot_;
  Eigen::Vector3d base_m_;
  Eigen::Vector2d axis_;
  std::uint32_t owner_;
};

/// Leaves swing once in 2.6 s, each structure's on their own.
double swing_of(std::size_t owner, double time_s) {
  constexpr double kPeriod_s = 2.6, kTurn_rad = 6.283185307179586;
  return sin_cos(kTurn_rad * (time_s / kPeriod_s + uniform(scatter_bits(owner)))).sin;
}

void place(SceneSnapshot& snapshot, const Structure& structure, double time_s) {
  const SinCos yaw = sin_cos(structure.yaw_rad);
  const double sway_m = structure.sway_m.value_or(0.0);
  snapshot.solids.push_back({.shape = structure.shape,
                             .center_m = to_vector(structure.center_m),
                             .half_size_m = to_vector(structure.size_m) / 2.0,
                             .axis = {yaw.cos, yaw.sin},
                             .density = structure.density,
                             .leaves_at_m = sway_m * swing_of(snapshot.owners.size(), time_s),
                             .let_through = structure.let_through.value_or(0.0),
                             .mirrors = structure.mirrors.value_or(false),
                             .owner = static_cast<std::uint32_t>(snapshot.owners.size())});
  const Substance solid =
      structure.shape == Shape::kCylinder ? Substance::kPole : Substance::kBuilding;
  snapshot.owners.push_back({.substance = structure.density < 1.0 ? Substance::kVegetation : solid,
                             .labelled = structure.labelled});
}

void add_pedestrian(Builder& body, double travelled_m) {
  constexpr double kStride_m = 1.4, kSwing_m = 0.28;
  const double swing_m = kSwing_m * sin_cos(6.283185307179586 * travelled_m / kStride_m).sin;
  body.cylinder({swing_m, 0.1, 0.42}, 0.08, 0.84);
  body.cylinder({-swing_m, -0.1, 0.42}, 0.08, 0.84);
  body.cylinder({0.0, 0.0, 1.14}, 0.21, 0.6);
  body.cylinder({-swing_m, 0.26, 1.1}, 0.05, 0.6);
  body.cylinder({swing_m, -0.26, 1.1}, 0.05, 0.6);
  body.sphere({0.0, 0.0, 1.6}, 0.13);
}

void add_cyclist(Builder& body) {
  body.box({0.55, 0.0, 0.34}, {0.66, 0.06, 0.66});
  body.box({-0.55, 0.0, 0.34}, {0.66, 0.06, 0.66});
  body.box({0.0, 0.0, 0.6}, {1.0, 0.06, 0.3});
  body.cylinder({-0.1, 0.12, 0.7}, 0.08, 0.6);
  body.cylinder({-0.1, -0.12, 0.7}, 0.08, 0.6);
  body.cylinder({-0.05, 0.0, 1.25}, 0.22, 0.6);
  body.sphere({0.05, 0.0, 1.7}, 0.14);
}

void add_car(Builder& body) {
  body.box({0.0, 0.0, 0.62}, {4.4, 1.8, 0.84});
  body.box({-0.3, 0.0, 1.26}, {2.4, 1.6, 0.46});
}

void add_truck(Builder& body) {
  body.box({4.0, 0.0, 1.55}, {2.0, 2.4, 2.5});
  body.box({-1.2, 0.0, 2.2}, {8.0, 2.5, 3.2});
}

bool is_vehicle(MoverKind kind) { return kind == MoverKind::kCar || kind == MoverKind::kTruck; }

void place(SceneSnapshot& snapshot, const Mover& mover, const Scene& scene, double time_s) {
  const RouteState state = route_state(mover.route, time_s);
  const double x_m = state.position_m.x(), y_m = state.position_m.y();
  const Eigen::Vector3d base_m(x_m, y_m, ground_height_m(scene.ground, x_m, y_m));
  Builder body(snapshot, base_m, state.heading);
  switch (mover.kind) {
    case MoverKind::kPedestrian:
      add_pedestrian(body, state.travelled_m);
      break;
    case MoverKind::kCyclist:
      add_cyclist(body);
      break;
    case MoverKind::kCar:
      add_car(body);
      break;
    case MoverKind::kTruck:
      add_truck(body);
      break;
  }
  const bool vehicle = is_vehicle(mover.kind);
  const double threshold_m_s = vehicle ? kMovingVehicleSpeed_m_s : kMovingSpeed_m_s;
  snapshot.owners.push_back(
      {.substance = Substance::kMoverBody,
       .mover = mover.kind,
       .labelled = mover.labelled,
       .moving = state.speed_m_s > threshold_m_s,
       .dynamic_by_appearance = mover.dynamic_by_appearance.value_or(!vehicle),
       .speed_m_s = state.speed_m_s,
       .base_m = base_m,
       .axis = state.heading});
}

struct LeafState {
  double yaw_rad, turn_rate_rad_s;
};

LeafState leaf_state(const Door& door, double time_s) {
  if (time_s < door.start_s) return {door.closed_yaw_rad, 0.0};
  const double phase_s = std::fmod(time_s - door.start_s, door.period_s);
  const double swing_rad = door.open_yaw_rad - door.closed_yaw_rad;
  const double rate_rad_s = swing_rad / door.swing_s;
  if (phase_s < door.swing_s) return {door.closed_yaw_rad + rate_rad_s * phase_s, rate_rad_s};
  const double closing_s = phase_s - door.period_s / 2.0;
  if (closing_s < 0.0) return {door.open_yaw_rad, 0.0};
  if (closing_s < door.swing_s) return {door.open_yaw_rad - rate_rad_s * closing_s, -rate_rad_s};
  return {door.closed_yaw_rad, 0.0};
}

void place(SceneSnapshot& snapshot, const Door& door, const Scene& scene, double time_s) {
  const LeafState leaf = leaf_state(door, time_s);
  const SinCos yaw = sin_cos(leaf.yaw_rad);
  constexpr double kThickness_m = 0.05;
  const double floor_m = ground_height_m(scene.ground, door.hinge_m[0], door.hinge_m[1]);
  const Eigen::Vector3d hinge_m(door.hinge_m[0], door.hinge_m[1], floor_m);
  Builder body(snapshot, hinge_m, {yaw.cos, yaw.sin});
  body.box({door.width_m / 2.0, 0.0, door.height_m / 2.0 + 0.01},
           {door.width_m, kThickness_m, door.height_m});
  // The speed of the leaf is that of its middle.
  const double speed_m_s = std::abs(leaf.turn_rate_rad_s) * door.width_m / 2.0;
  snapshot.owners.push_back({.substance = Substance::kDoor,
                             .labelled = door.labelled,
                             .moving = speed_m_s > kMovingSpeed_m_s,
                             .speed_m_s = speed_m_s,
                             .base_m = hinge_m,
                             .axis = {yaw.cos, yaw.sin}});
}

/// Returns the seconds of free flight until the ball touches the first of the planes.
double flight_duration_s(const Ball& ball, std::span<const GroundPlane> ground) {
  constexpr double kGravity_m_s2 = 9.81;
  static constexpr GroundPlane kFlat{};
  const std::span<const GroundPlane> planes = ground.empty() ? std::span(&kFlat, 1) : ground;
  double earliest_s = 1e300;
  for (const GroundPlane& plane : planes) {
    const double gap_m = ball.from_m[2] - ball.radius_m - plane.height_m -
                         plane.slope_x * ball.from_m[0] - plane.slope_y * ball.from_m[1];
    if (gap_m <= 0.0) return 0.0;
    const double climb_m_s = ball.velocity_m_s[2] - plane.slope_x * ball.velocity_m_s[0] -
                             plane.slope_y * ball.velocity_m_s[1];
    const double root = std::sqrt(climb_m_s * climb_m_s + 2.0 * kGravity_m_s2 * gap_m);
    earliest_s = std::min(earliest_s, (climb_m_s + root) / kGravity_m_s2);
  }
  return earliest_s;
}

void place(SceneSnapshot& snapshot, const Ball& ball, const Scene& scene, double time_s) {
  constexpr double kGravity_m_s2 = 9.81;
  const double since_start_s = time_s - ball.start_s;
  const double phase_s = since_start_s > 0.0 ? std::fmod(since_start_s, ball.period_s) : 0.0;
  const double landing_s = flight_duration_s(ball, scene.ground);
  const bool flying = since_start_s >= 0.0 && phase_s < landing_s;
  const double flown_s = std::min(phase_s, landing_s);
  Eigen::Vector3d velocity_m_s = to_vector(ball.velocity_m_s);
  Eigen::Vector3d center_m = to_vector(ball.from_m) + flown_s * velocity_m_s;
  center_m.z() -= 0.5 * kGravity_m_s2 * flown_s * flown_s;
  velocity_m_s.z() -= kGravity_m_s2 * flown_s;

  Builder(snapshot, center_m, Eigen::Vector2d::UnitX()).sphere({0.0, 0.0, 0.0}, ball.radius_m);
  const double speed_m_s =
      flying ? std::sqrt(velocity_m_s.x() * velocity_m_s.x() + velocity_m_s.y() * velocity_m_s.y() +
                         velocity_m_s.z() * velocity_m_s.z())
             : 0.0;
  snapshot.owners.push_back({.substance = Substance::kBall,
                             .labelled = ball.labelled,
                             .moving = speed_m_s > kMovingSpeed_m_s,
                             .dynamic_by_appearance = true,
                             .speed_m_s = speed_m_s,
                             .base_m = center_m});
}

}  // namespace

SceneSnapshot snapshot(const Scene& scene, double time_s) {
  SceneSnapshot result;
  result.owners.push_back({.substance = Substance::kGround});
  for (const Structure& structure : scene.structures) place(result, structure, time_s);
  for (const Mover& mover : scene.movers) place(result, mover, scene, time_s);
  for (const Door& door : scene.doors) place(result, door, scene, time_s);
  for (const Ball& ball : scene.balls) place(result, ball, scene, time_s);
  return result;
}

}  // namespace mosbench
