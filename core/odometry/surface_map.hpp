#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <unordered_map>

namespace mosbench::odometry {

/// Returns a key of the cube of a grid that holds the position; wraps after 2^21 cubes.
std::uint64_t cube_key(const Eigen::Vector3d& position_m, double size_m);

/// A surface with the directions in which it holds a point: a plane along its normal, a pole
/// sideways, a bush in all.
struct Surface {
  Eigen::Vector3d mean_m;
  Eigen::Matrix3d directions;  ///< columns; the first is a plane's normal
  Eigen::Vector3d
      variance_m2;  ///< of its points along each direction; infinite where it holds none
  bool is_plane;
};

/// The surfaces of scans, one normal distribution per cube of 1 m (the NDT of Biber and Strasser,
/// 2003). Single rings of points are no surface: they move with the sensor.
class SurfaceMap {
 public:
  /// Enters points of the next scan and forgets what was not seen for 100 scans.
  void enter(std::span<const Eigen::Vector3d> points_m, const Pose& map_from_sensor);
  /// The surface in the cube of a position; null where there is none. Until the next `enter`.
  const Surface* at(const Eigen::Vector3d& position_m) const;

 private:
  struct Cell {
    double count = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    std::size_t last_scan = 0;
    bool is_fitted = false;
    std::optional<Surface> surface;
  };
  static std::optional<Surface> fitted(const Cell& cell);

  mutable std::unordered_map<std::uint64_t, Cell> cells_;  // surfaces are fitted when asked for
  std::size_t scans_ = 0;
};

}  // namespace mosbench::odometry
