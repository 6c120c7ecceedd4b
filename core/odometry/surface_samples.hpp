#pragma once

#include <Eigen/Core>
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

}  // namespace mosbench::odometry
