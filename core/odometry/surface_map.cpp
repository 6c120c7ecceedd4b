#include "core/odometry/surface_map.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kCell_m = 1.0;
constexpr std::size_t kForgottenAfterScans = 100;
/// Older points count half whenever a cell has more, so that surfaces follow small errors.
constexpr double kMostPoints = 2000.0;
constexpr double kFewestPoints = 8.0;
/// Points deviate more along a direction in which a surface is spread.
constexpr double kSpread_m = 0.12;
constexpr double kNoHold = std::numeric_limits<double>::infinity();

}  // namespace

std::uint64_t cube_key(const Eigen::Vector3d& position_m, double size_m) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cube = static_cast<std::int64_t>(std::floor(position_m[axis] / size_m));
    key = (key << 21U) | (static_cast<std::uint64_t>(cube) & 0x1FFFFFU);
  }
  return key;
}

void SurfaceMap::enter(std::span<const Eigen::Vector3d> points_m, const Pose& map_from_sensor) {
  ++scans_;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d q = moved(map_from_sensor, point_m);
    Cell& cell = cells_[cube_key(q, kCell_m)];
    if (cell.count > kMostPoints && cell.last_scan != scans_) {
      cell.count /= 2;
      cell.sum /= 2;
      cell.squares /= 2;
    }
    cell.count += 1;
    cell.sum += q;
    cell.squares += q * q.transpose();
    cell.last_scan = scans_;
    cell.is_fitted = false;
  }
  std::erase_if(cells_, [&](const auto& entry) {
    return entry.second.last_scan + kForgottenAfterScans < scans_;
  });
}

std::optional<Surface> SurfaceMap::fitted(const Cell& cell) {
  if (cell.count < kFewestPoints) return std::nullopt;
  const Eigen::Vector3d mean_m = cell.sum / cell.count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(cell.squares / cell.count - mean_m * mean_m.transpose());
  Surface surface{mean_m, eigen.eigenvectors(), eigen.eigenvalues().cwiseMax(0.0), false};
  Eigen::Vector3d& variance_m2 = surface.variance_m2;
  constexpr double kSpread_m2 = kSpread_m * kSpread_m, kUpright = 0.8;
  if (variance_m2[0] > kSpread_m2) return surface;  // a bush
  if (variance_m2[1] > kSpread_m2) {
    surface.is_plane = true;
    variance_m2[1] = variance_m2[2] = kNoHold;
    return surface;
  }
  if (std::abs(surface.directions(2, 2)) < kUpright) return std::nullopt;  // a ring
  variance_m2[2] = kNoHold;                                                // a pole
  return surface;
}

const Surface* SurfaceMap::at(const Eigen::Vector3d& position_m) const {
  const auto found = cells_.find(cube_key(position_m, kCell_m));
  if (found == cells_.end()) return nullptr;
  Cell& cell = found->second;
  if (!cell.is_fitted) cell.surface = fitted(cell);
  cell.is_fitted = true;
  return cell.surface ? &*cell.surface : nullptr;
}

}  // namespace mosbench::odometry
