#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// What a scene file may hold for a field: the closed interval of a number (for a list, of each of
/// its numbers) and whether the key must be there.
struct FieldRule {
  double lowest = -1e5;
  double highest = 1e5;
  bool required = false;
};

inline constexpr FieldRule kPosition{.required = true};
inline constexpr FieldRule kDuration{.lowest = 0.0, .highest = 1e6};
inline constexpr FieldRule kSize{.lowest = 0.01, .highest = 1e4};
inline constexpr FieldRule kSpeed{.lowest = 0.01, .highest = 100.0, .required = true};
inline constexpr FieldRule kAngle{.lowest = -10.0, .highest = 10.0};
inline constexpr FieldRule kMust{.required = true};

template <typename T, typename Record>
concept Of = std::same_as<std::remove_const_t<T>, Record>;

// The one list of fields per record: visit_fields(record, visit) calls visit(key, member, rule) for
// each. Reading, writing and the unknown-key check of scene files all walk these.

void visit_fields(Of<Leg> auto& leg, auto&& visit) {
  visit("to_m", leg.to_m, kPosition);
  visit("speed_m_s", leg.speed_m_s, kSpeed);
  visit("wait_s", leg.wait_s, kDuration);
}

void visit_fields(Of<Route> auto& route, auto&& visit) {
  visit("from_m", route.from_m, kPosition);
  visit("legs", route.legs, FieldRule{});
  visit("after", route.after, FieldRule{});
  visit("start_s", route.start_s, kDuration);
}

void visit_fields(Of<Ego> auto& ego, auto&& visit) {
  visit("carrier", ego.carrier, kMust);
  visit("sensor_height_m", ego.sensor_height_m, FieldRule{.lowest = 0.1, .highest = 100.0});
  visit("route", ego.route, kMust);
}

void visit_fields(Of<GroundPlane> auto& plane, auto&& visit) {
  visit("height_m", plane.height_m, FieldRule{});
  visit("slope_x", plane.slope_x, FieldRule{.lowest = -2.0, .highest = 2.0});
  visit("slope_y", plane.slope_y, FieldRule{.lowest = -2.0, .highest = 2.0});
}

void visit_fields(Of<Structure> auto& structure, auto&& visit) {
  visit("shape", structure.shape, kMust);
  visit("center_m", structure.center_m, kPosition);
  visit("size_m", structure.size_m, FieldRule{.lowest = 0.01, .highest = 1e4, .required = true});
  visit("yaw_rad", structure.yaw_rad, kAngle);
  visit("density", structure.density, FieldRule{.lowest = 0.01, .highest = 1.0});
  visit("sway_m", structure.sway_m, FieldRule{.lowest = 0.0, .highest = 2.0});
  visit("let_through", structure.let_through, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("mirrors", structure.mirrors, FieldRule{});
  visit("labelled", structure.labelled, FieldRule{});
}

void visit_fields(Of<Mover> auto& mover, auto&& visit) {
  visit("kind", mover.kind, kMust);
  visit("route", mover.route, kMust);
  visit("labelled", mover.labelled, FieldRule{});
  visit("dynamic_by_appearance", mover.dynamic_by_appearance, FieldRule{});
}

void visit_fields(Of<Door> auto& door, auto&& visit) {
  visit("hinge_m", door.hinge_m, kPosition);
  visit("width_m", door.width_m, kSize);
  visit("height_m", door.height_m, kSize);
  visit("closed_yaw_rad", door.closed_yaw_rad, kAngle);
  visit("open_yaw_rad", door.open_yaw_rad, kAngle);
  visit("swing_s", door.swing_s, FieldRule{.lowest = 0.05, .highest = 1e4});
  visit("period_s", door.period_s, FieldRule{.lowest = 0.1, .highest = 1e6});
  visit("start_s", door.start_s, kDuration);
  visit("labelled", door.labelled, FieldRule{});
}

void visit_fields(Of<Ball> auto& ball, auto&& visit) {
  visit("from_m", ball.from_m, kPosition);
  visit("velocity_m_s", ball.velocity_m_s, FieldRule{.lowest = -100.0, .highest = 100.0});
  visit("radius_m", ball.radius_m, FieldRule{.lowest = 0.01, .highest = 10.0});
  visit("period_s", ball.period_s, FieldRule{.lowest = 0.1, .highest = 1e6});
  visit("start_s", ball.start_s, kDuration);
  visit("labelled", ball.labelled, FieldRule{});
}

void visit_fields(Of<Scene> auto& scene, auto&& visit) {
  visit("name", scene.name, kMust);
  visit("scan_period_s", scene.scan_period_s, FieldRule{.lowest = 0.001, .highest = 10.0});
  visit("sensor", scene.sensor, FieldRule{});
  visit("columns", scene.columns, FieldRule{.lowest = 16, .highest = 8192});
  visit("range_noise_m", scene.range_noise_m, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("dropout_probability", scene.dropout_probability, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("beam_width_rad", scene.beam_width_rad, FieldRule{.lowest = 0.0, .highest = 0.05});
  visit("ground_bumps_m", scene.ground_bumps_m, FieldRule{.lowest = 0.0, .highest = 0.5});
  visit("ego", scene.ego, kMust);
  visit("ground", scene.ground, FieldRule{});
  visit("structures", scene.structures, FieldRule{});
  visit("movers", scene.movers, FieldRule{});
  visit("doors", scene.doors, FieldRule{});
  visit("balls", scene.balls, FieldRule{});
}

/// The names that enumerators have in scene files.
template <typename Enum, std::size_t kCount>
using EnumNames = std::array<std::pair<Enum, std::string_view>, kCount>;

constexpr EnumNames<AfterRoute, 3> names_of(AfterRoute) {
  return {{{AfterRoute::kStay, "stay"},
           {AfterRoute::kReturn, "return"},
           {AfterRoute::kRestart, "restart"}}};
}

constexpr EnumNames<Carrier, 4> names_of(Carrier) {
  return {{{Carrier::kTripod, "tripod"},
           {Carrier::kHandHeld, "hand-held"},
           {Carrier::kGroundRobot, "ground-robot"},
           {Carrier::kCar, "car"}}};
}

constexpr EnumNames<Shape, 3> names_of(Shape) {
  return {{{Shape::kBox, "box"}, {Shape::kCylinder, "cylinder"}, {Shape::kSphere, "sphere"}}};
}

constexpr EnumNames<MoverKind, 4> names_of(MoverKind) {
  return {{{MoverKind::kPedestrian, "pedestrian"},
           {MoverKind::kCyclist, "cyclist"},
           {MoverKind::kCar, "car"},
           {MoverKind::kTruck, "truck"}}};
}

}  // namespace mosbench
