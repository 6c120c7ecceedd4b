#include "datasets/doctor/surface_cells.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mosbench {
namespace {

constexpr double kCellSizeM = 1.0;
constexpr double kThinnestM = 0.08;  // noise and unevenness of a surface
constexpr std::size_t kFewestPoints = 5;

constexpr double kFarthestCell = 1 << 20;
constexpr std::uint64_t kNowhere = std::uint64_t{1} << 63U;  // no cell that fits 3 x 21 bits

std::uint64_t key_of(const Eigen::Vector3d& point_m) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(point_m[axis] / kCellSizeM);
    if (!(std::abs(cell) < kFarthestCell)) return kNowhere;
    key = (key << 21U) | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x1FFFFFU);
  }
  return key;
}

struct Moments {
  std::size_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
};

}  // namespace

SurfaceCells::SurfaceCells(std::span<const Eigen::Vector3d> points_m) {
  std::unordered_map<std::uint64_t, Moments> moments_of_cell;
  for (const Eigen::Vector3d& point_m : points_m) {
    Moments& moments = moments_of_cell[key_of(point_m)];
    ++moments.count;
    moments.sum += point_m;
    moments.squares += point_m * point_m.transpose();
  }
  for (const auto& [key, moments] : moments_of_cell) {
    if (moments.count < kFewestPoints) continue;
    const double n = static_cast<double>(moments.count);
    Cell& cell = cells_[key];
    cell.mean_m = moments.sum / n;
    const Eigen::Matrix3d covariance = moments.squares / n - cell.mean_m * cell.mean_m.transpose() +
                                       kThinnestM * kThinnestM * Eigen::Matrix3d::Identity();
    cell.information = covariance.inverse();
  }
}

double SurfaceCells::overlap(std::span<const Eigen::Vector3d> points_m,
                             const Pose& cells_from_points) const {
  if (points_m.empty()) return 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d moved_m = cells_from_points * point_m;
    const auto cell = cells_.find(key_of(moved_m));
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

std::vector<Eigen::Vector3d> upright_points(std::span<const Eigen::Vector3d> points_m) {
  constexpr double kFlatM = 0.5;
  constexpr std::size_t kFewest = 5000;
  const auto column_of = [](const Eigen::Vector3d& point_m) {
    return key_of({point_m.x(), point_m.y(), 0.0});
  };
  std::unordered_map<std::uint64_t, std::pair<double, double>> ends_of_column;
  for (const Eigen::Vector3d& point_m : points_m) {
    const auto found = ends_of_column.try_emplace(column_of(point_m), point_m.z(), point_m.z());
    auto& [low_m, high_m] = found.first->second;
    low_m = std::min(low_m, point_m.z());
    high_m = std::max(high_m, point_m.z());
  }
  std::vector<Eigen::Vector3d> upright_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    const auto& [low_m, high_m] = ends_of_column.at(column_of(point_m));
    if (high_m - low_m >= kFlatM) upright_m.push_back(point_m);
  }
  if (upright_m.size() < kFewest) upright_m.assign(points_m.begin(), points_m.end());
  return upright_m;
}

std::vector<Eigen::Vector3d> picked(std::span<const Eigen::Vector3d> points_m, std::size_t most) {
  if (points_m.size() <= most) return {points_m.begin(), points_m.end()};
  std::vector<Eigen::Vector3d> picked_m;
  for (std::size_t i = 0; i < most; ++i) picked_m.push_back(points_m[i * points_m.size() / most]);
  return picked_m;
}

Alignment align(const SurfaceCells& cells, std::span<const Eigen::Vector3d> points_m,
                const Pose& start) {
  Alignment best{start, cells.overlap(points_m, start)};
  for (double step = 0.4; step > 0.02; step /= 2.0) {
    for (bool improved = true; improved;) {
      improved = false;
      for (int direction = 0; direction < 12; ++direction) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit((direction / 2) % 3);
        const double signed_step = direction % 2 == 0 ? step : -step;
        Pose candidate = best.cells_from_points;
        if (direction < 6) {
          candidate.translation() += signed_step * axis;
        } else {
          // A tenth of a radian moves points 10 m away by a metre.
          candidate.rotate(Eigen::AngleAxisd(0.1 * signed_step, axis));
        }
        const double overlap = cells.overlap(points_m, candidate);
        if (!(overlap > best.overlap + 1e-4)) continue;  // nor when it is no number
        best = {candidate, overlap};
        improved = true;
      }
    }
  }
  return best;
}

}  // namespace mosbench
