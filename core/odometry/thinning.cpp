#include "core/odometry/thinning.hpp"

#include <limits>

namespace mosbench::odometry {

std::vector<std::size_t> insert_apart(std::span<const Eigen::Vector3d> points_m, double radius_m,
                                      PointGrid& grid) {
  std::vector<std::size_t> inserted;
  // Points next to one another in a file mostly lie next to one another: the point that was in the
  // way of the one before is tried first.
  Eigen::Vector3d in_the_way = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d& point_m = points_m[i];
    if ((in_the_way - point_m).squaredNorm() < radius_m * radius_m) continue;
    if (grid.any_within(point_m, radius_m, in_the_way)) continue;
    grid.insert(point_m);
    inserted.push_back(i);
    in_the_way = point_m;
  }
  return inserted;
}

std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points_m, double radius_m) {
  PointGrid grid(radius_m);
  std::vector<Eigen::Vector3d> kept;
  for (const std::size_t i : insert_apart(points_m, radius_m, grid)) kept.push_back(points_m[i]);
  return kept;
}

std::vector<Eigen::Vector3d> first_of_cells(std::span<const Eigen::Vector3d> points_m,
                                            double cell_m) {
  PointGrid grid(cell_m);
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& point_m : points_m) {
    if (grid.holds_cell_of(point_m)) continue;
    grid.insert(point_m);
    kept.push_back(point_m);
  }
  return kept;
}

std::vector<Eigen::Vector3d> every_nth(std::span<const Eigen::Vector3d> points_m, std::size_t n) {
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < points_m.size(); i += n) kept.push_back(points_m[i]);
  return kept;
}

}  // namespace mosbench::odometry
