#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace mosbench::odometry {

/// What the surfaces of a scan say about a small motion of the sensor.
struct SurfaceInformation {
  /// Mean over the sampled points of J' M J with J = [-[p]x, I]: rotation (rad) before translation
  /// (m), in the sensor's frame. M is n n' on a plane with normal n, nearly the identity in a
  /// thicket, and nothing on a single line of points, which may belong to any surface through it.
  Eigen::Matrix<double, 6, 6> mean = Eigen::Matrix<double, 6, 6>::Zero();
  double mean_range_m = 0;
  std::size_t samples = 0;
};

/// How well a pose is known.
struct Certainty {
  /// Rotation (rad) before translation (m), in the sensor's frame. Finite in any case: directions
  /// that nothing constrains are given a large variance.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Of the information with rotations measured by how far they move a point at the mean range:
  /// largest by smallest eigenvalue, at most some 1e9.
  double condition = 0;
  /// What is known of the least known motion as a share of what a point that is held fast knows: of
  /// shifts with turns left free, and of turns, by a lever of 1 m, with shifts left free.
  double weakest = 0;
  /// That motion: a unit vector in one half, zeros in the other.
  Eigen::Matrix<double, 6, 1> weakest_direction = Eigen::Matrix<double, 6, 1>::Zero();
};

/// Of a scan with these surfaces whose points, as many as `effective_points`, lie `residual_m` off
/// the map.
Certainty certainty_of(const SurfaceInformation& information, double residual_m,
                       double effective_points);

/// Looks at points `spacing_m` apart. Takes some hundred of them as samples.
SurfaceInformation surface_information(std::span<const Eigen::Vector3d> points_m, double spacing_m);

}  // namespace mosbench::odometry
