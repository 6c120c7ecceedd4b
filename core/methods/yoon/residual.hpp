#pragma once

#include <Eigen/Core>
#include <span>

#include "core/methods/yoon/point_cells.hpp"

namespace mosbench::yoon {

/// How far a point is from a reference scan.
struct Residual {
  float distance_m;  ///< to the plane of the ten nearest points, else to the nearest one
  bool to_plane;
};

/// Residuals end here: nothing is looked for farther away.
inline constexpr float kFarthest_m = 0.6F;

/// Returns the residual of a point. `reference` are the points in `cells`, whose edge is
/// kFarthest_m. Ten points are a plane when the smallest eigenvalue of their covariance is less
/// than `planar_share` of the sum.
Residual residual_of(const Eigen::Vector3f& point, std::span<const Eigen::Vector3f> reference,
                     const PointCells& cells, double planar_share);

}  // namespace mosbench::yoon
