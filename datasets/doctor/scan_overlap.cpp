#include "datasets/doctor/scan_overlap.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

constexpr double kCellM = 1.0;

}  // namespace

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair) {
  return poses[pair.earlier].inverse() * poses[pair.later];
}

double difference_m(const Pose& a, const Pose& b) {
  constexpr double kRangeM = 10.0;
  const Pose between = a.inverse() * b;
  return between.translation().norm() + kRangeM * Eigen::AngleAxisd(between.linear()).angle();
}

double median(std::vector<double> values) {
  return values.empty() ? 0.0 : quantile(std::move(values), 0.5, QuantileRule::kUpper);
}

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

const ScanOverlap::Scan& ScanOverlap::at(std::size_t scan_index) {
  constexpr std::size_t kSurfacePoints = 40000, kMovedPoints = 1500, kFewestOfSurface = 5;
  constexpr double kThinnestM = 0.08;  // noise and unevenness of a surface
  if (const auto known = scans_.find(scan_index); known != scans_.end()) return known->second;
  const std::vector<Eigen::Vector3d> near_m = near_points(sequence_.read(scan_index).points);
  Scan& scan = scans_[scan_index];
  scan.moved_m = picked(near_m, kMovedPoints);
  for (const auto& [key, moments] : moments_of_cells(picked(near_m, kSurfacePoints), kCellM)) {
    if (moments.count < kFewestOfSurface) continue;
    const Eigen::Matrix3d covariance_m2 =
        moments.covariance_m2() + kThinnestM * kThinnestM * Eigen::Matrix3d::Identity();
    scan.surfaces.emplace(key, Surface{moments.mean_m(), covariance_m2.inverse()});
  }
  return scan;
}

bool ScanOverlap::has_points(const ScanPair& pair) {
  constexpr std::size_t kFewestPoints = 200;
  return at(pair.later).moved_m.size() >= kFewestPoints;
}

double ScanOverlap::overlap(const ScanPair& pair, const Pose& motion) {
  const auto& surfaces = at(pair.earlier).surfaces;
  const std::vector<Eigen::Vector3d>& points_m = at(pair.later).moved_m;
  double sum = 0.0;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d moved_m = motion * point_m;
    const auto surface = surfaces.find(cube_key(moved_m, kCellM));
    if (surface == surfaces.end()) continue;
    const Eigen::Vector3d offset_m = moved_m - surface->second.mean_m;
    sum += std::exp(-0.5 * offset_m.dot(surface->second.information * offset_m));
  }
  return points_m.empty() ? 0.0 : sum / static_cast<double>(points_m.size());
}

}  // namespace mosbench
