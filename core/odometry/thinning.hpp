#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/odometry/point_grid.hpp"

namespace mosbench::odometry {

/// The points, in order, that have no kept point nearer than `radius_m` (strictly) before them.
std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points_m, double radius_m);

/// Inserts in order those points that have no point of the grid nearer than `radius_m` (strictly),
/// which is at most the edge of its cells. Returns the positions of the inserted ones in
/// `points_m`.
std::vector<std::size_t> insert_apart(std::span<const Eigen::Vector3d> points_m, double radius_m,
                                      PointGrid& grid);

/// The first point of every cell of edge `cell_m`, in order.
std::vector<Eigen::Vector3d> first_of_cells(std::span<const Eigen::Vector3d> points_m,
                                            double cell_m);

/// The first point and every n-th after it.
std::vector<Eigen::Vector3d> every_nth(std::span<const Eigen::Vector3d> points_m, std::size_t n);

}  // namespace mosbench::odometry
