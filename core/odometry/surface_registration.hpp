#pragma once

#include <Eigen/Core>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/odometry/surface_map.hpp"

namespace mosbench::odometry {

/// Translation and rotation of a pose from another, both in the map's frame.
using Offset6 = Eigen::Matrix<double, 6, 1>;
Offset6 offset(const Pose& pose, const Pose& from);
/// Moves and turns a pose about its own place.
Pose moved_by(const Pose& pose, const Offset6& step);

/// A scan in the two forms that registration needs.
struct SurfacePoints {
  explicit SurfacePoints(std::span<const Point> points);

  std::vector<Eigen::Vector3d> entered_m;     ///< that make up surfaces
  std::vector<Eigen::Vector3d> registered_m;  ///< at most one per cube, so that near ones do not
                                              ///< outweigh far ones
};

/// Returns the pose near `guess` that brings the points onto the surfaces of the map. The guess
/// holds where the surfaces do not. Nothing where few points meet surfaces, or where they draw the
/// scan far away.
std::optional<Pose> registered(const SurfaceMap& map, const SurfacePoints& scan, const Pose& guess);

/// Returns the mean distance of the points from the planes of the map that they meet; nothing where
/// these are few.
std::optional<double> fit_m(const SurfaceMap& map, const SurfacePoints& scan, const Pose& pose);

}  // namespace mosbench::odometry
