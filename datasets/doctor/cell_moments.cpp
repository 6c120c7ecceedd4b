#include "datasets/doctor/cell_moments.hpp"

#include <cmath>

namespace mosbench {

std::uint64_t cube_key(const Eigen::Vector3d& point_m, double size_m) {
  constexpr double kFarthestCell = 1 << 20;
  constexpr std::uint64_t kNowhere = std::uint64_t{1} << 63U;  // no cell that fits 3 x 21 bits
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(point_m[axis] / size_m);
    if (!(std::abs(cell) < kFarthestCell)) return kNowhere;
    key = (key << 21U) | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x1FFFFFU);
  }
  return key;
}

Eigen::Matrix3d CellMoments::covariance_m2() const {
  const Eigen::Vector3d mean = mean_m();
  return squares / static_cast<double>(count) - mean * mean.transpose();
}

std::unordered_map<std::uint64_t, CellMoments> moments_of_cells(
    std::span<const Eigen::Vector3d> points_m, double size_m) {
  std::unordered_map<std::uint64_t, CellMoments> cells;
  for (const Eigen::Vector3d& point_m : points_m) {
    CellMoments& cell = cells[cube_key(point_m, size_m)];
    ++cell.count;
    cell.sum += point_m;
    cell.squares += point_m * point_m.transpose();
  }
  return cells;
}

}  // namespace mosbench
