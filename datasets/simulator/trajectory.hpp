#pragma once

#include <Eigen/Core>
#include <mosbench/scan.hpp>
#include <span>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// Position and motion on a route at one instant.
struct RouteState {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();  ///< unit vector, also while standing
  double speed_m_s = 0.0;
  double travelled_m = 0.0;  ///< since the start of the route's current pass
};

RouteState route_state(const Route& route, double time_s);

/// Returns the duration of one pass over the legs.
double route_duration_s(const Route& route);

/// Returns the closed path through the corners of a rectangle, counter-clockwise unless
/// `clockwise`, that starts at `fraction` of its length; every leg at `speed_m_s`, after standing
/// `wait_s` at each corner.
Route rectangle_route(std::array<double, 2> low_m, std::array<double, 2> high_m, bool clockwise,
                      double fraction, double speed_m_s, double wait_s = 0.0);

/// Returns the height of the highest plane; 0 without planes.
double ground_height_m(std::span<const GroundPlane> ground, double x_m, double y_m);

/// Returns the carrier's frame at the sensor's height (x ahead, z up), with rounded corners and the
/// bobbing and swaying of its kind.
Pose ego_pose(const Scene& scene, double time_s);

}  // namespace mosbench
