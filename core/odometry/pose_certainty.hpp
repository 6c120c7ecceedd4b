#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace mosbench::odometry {

/// A point of a scan with the surface around it.
struct SurfaceSample {
  Eigen::Vector3d point_m;  ///< sensor frame
  /// The directions in which the surface holds the point in place: n n' on a plane with normal n,
  /// nearly the identity in a thicket.
  Eigen::Matrix3d hold;
};

/// Some hundred of the points, which lie about `spacing_m` apart. A point with few neighbours or on
/// a single line of points, which may belong to any surface through it, is no sample.
std::vector<SurfaceSample> surface_samples(std::span<const Eigen::Vector3d> points_m,
                                           double spacing_m);

/// A small motion of the sensor in its frame: rotation (rad) before translation (m).
using Motion6 = Eigen::Matrix<double, 6, 1>;

/// How well a pose is known by the surfaces of its scan, which may be asked whatever found it.
struct Certainty {
  /// Of a `Motion6` of the pose, from how far surfaces scatter about those of the map and the
  /// motion that would bring them there. Finite in any case: directions that nothing constrains are
  /// given a large variance.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Of the information with rotations measured by how far they move a point at the mean range:
  /// largest by smallest eigenvalue, at most some 1e9.
  double condition = 0;
  /// What is known of the least known motion as a share of what a point that is held fast knows: of
  /// shifts with turns left free, and of turns, by a lever of 1 m, with shifts left free.
  double weakest = 0;
  /// That motion: a unit vector in one half, zeros in the other.
  Motion6 weakest_direction = Motion6::Zero();
  Eigen::Vector3d weakest_shift = Eigen::Vector3d::Zero();  ///< the least known one, length 1
};

/// `offsets_m` are those of the samples, at the pose in question, from the map point nearest to
/// them, in the sensor's frame; nothing where the map has none near.
Certainty certainty_of(std::span<const SurfaceSample> samples,
                       std::span<const std::optional<Eigen::Vector3d>> offsets_m);

}  // namespace mosbench::odometry
