#pragma once

#include <Eigen/Core>
#include <mosbench/scan.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace mosbench {

/// The surfaces of a scan as one normal distribution per cell of a grid (the NDT of Biber and
/// Strasser, 2003). Unlike the distance to the nearest point it does not favour standing still
/// because of the rings of a sparse sensor on the ground.
class SurfaceCells {
 public:
  explicit SurfaceCells(std::span<const Eigen::Vector3d> points_m);

  /// Returns how well points of another scan lie on the surfaces: the mean over the points of a
  /// likelihood that is 1 in the middle of a surface and 0 where there is none.
  double overlap(std::span<const Eigen::Vector3d> points_m, const Pose& cells_from_points) const;

 private:
  struct Cell {
    Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  };
  std::unordered_map<std::uint64_t, Cell> cells_;
};

/// Returns the points at 2 to 40 m, where scans are dense.
std::vector<Eigen::Vector3d> near_points(std::span<const Point> points);

/// Returns up to `most` of the points, evenly picked.
std::vector<Eigen::Vector3d> picked(std::span<const Eigen::Vector3d> points_m, std::size_t most);

}  // namespace mosbench
