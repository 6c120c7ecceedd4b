#include "datasets/doctor/surface_cells.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "datasets/doctor/cell_moments.hpp"

namespace mosbench {
namespace {

constexpr double kCellSizeM = 1.0;
constexpr double kThinnestM = 0.08;  // noise and unevenness of a surface
constexpr std::size_t kFewestPoints = 5;

}  // namespace

SurfaceCells::SurfaceCells(std::span<const Eigen::Vector3d> points_m) {
  for (const auto& [key, moments] : moments_of_cells(points_m, kCellSizeM)) {
    if (moments.count < kFewestPoints) continue;
    const Eigen::Matrix3d covariance_m2 =
        moments.covariance_m2() + kThinnestM * kThinnestM * Eigen::Matrix3d::Identity();
    cells_.emplace(key, Cell{moments.mean_m(), covariance_m2.inverse()});
  }
}

double SurfaceCells::overlap(std::span<const Eigen::Vector3d> points_m,
                             const Pose& cells_from_points) const {
  if (points_m.empty()) return 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d moved_m = cells_from_points * point_m;
    const auto cell = cells_.find(cube_key(moved_m, kCellSizeM));
    if (cell == cells_.end()) continue;
    const Eigen::Vector3d offset_m = moved_m - cell->second.mean_m;
    sum += std::exp(-0.5 * offset_m.dot(cell->second.information * offset_m));
  }
  return sum / static_cast<double>(points_m.size());
}

std::vector<Eigen::Vector3d> near_points(std::span<const Point> points) {
  constexpr double kNearestM = 2.0, kFurthestM = 40.0;
  std::vector<Eigen::Vector3d> near_m;
  for (const Point& point : points) {
    const Eigen::Vector3d point_m(point.x, point.y, point.z);
    const double range_m = point_m.norm();
    if (range_m >= kNearestM && range_m <= kFurthestM) near_m.push_back(point_m);
  }
  return near_m;
}

std::vector<Eigen::Vector3d> picked(std::span<const Eigen::Vector3d> points_m, std::size_t most) {
  if (points_m.size() <= most) return {points_m.begin(), points_m.end()};
  std::vector<Eigen::Vector3d> picked_m;
  for (std::size_t i = 0; i < most; ++i) picked_m.push_back(points_m[i * points_m.size() / most]);
  return picked_m;
}

}  // namespace mosbench
