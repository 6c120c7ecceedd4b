#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>

namespace mosbench {

/// Returns a key of the cube of a grid that holds the point; one and the same key for all points
/// that are too far away for the grid.
std::uint64_t cube_key(const Eigen::Vector3d& point_m, double size_m);

/// Points of a cube, summed up.
struct CellMoments {
  std::size_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  Eigen::Vector3d mean_m() const { return sum / static_cast<double>(count); }
  Eigen::Matrix3d covariance_m2() const;
};

/// Sums up the points by cubes.
std::unordered_map<std::uint64_t, CellMoments> moments_of_cells(
    std::span<const Eigen::Vector3d> points_m, double size_m);

}  // namespace mosbench
