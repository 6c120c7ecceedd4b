#include "core/odometry/scan_points.hpp"

#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kCorrection_rad = 0.205 * 3.14159265358979323846 / 180.0;

}  // namespace

Eigen::Vector3d raised(const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d axis = point_m.cross(Eigen::Vector3d::UnitZ());
  const double length = axis.norm();
  if (length == 0) return point_m;
  return rotation_about(axis * (kCorrection_rad / length)) * point_m;
}

ScanPoints points_in_range(std::span<const Point> points, const ScanConfig& config) {
  const double min_sq_m2 = config.min_range_m * config.min_range_m;
  const double max_sq_m2 = config.max_range_m * config.max_range_m;
  ScanPoints kept;
  kept.points_m.reserve(points.size());
  kept.rows.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p(points[i].x, points[i].y, points[i].z);
    const double range_sq_m2 = p.x() * p.x() + p.y() * p.y() + p.z() * p.z();
    if (!(range_sq_m2 > min_sq_m2 && range_sq_m2 < max_sq_m2)) continue;
    kept.points_m.push_back(config.kitti_correction == Switch::kOn ? raised(p) : p);
    kept.rows.push_back(i);
  }
  return kept;
}

ScanPoints without(const ScanPoints& scan, std::span<const std::uint8_t> moving) {
  ScanPoints kept;
  for (std::size_t i = 0; i < scan.rows.size(); ++i) {
    if (moving[scan.rows[i]] != 0) continue;
    kept.points_m.push_back(scan.points_m[i]);
    kept.rows.push_back(scan.rows[i]);
  }
  return kept;
}

}  // namespace mosbench::odometry
