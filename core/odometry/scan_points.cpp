#include "core/odometry/scan_points.hpp"

#include <algorithm>
#include <optional>

#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kCorrection_rad = 0.205 * 3.14159265358979323846 / 180.0;

// No point is moved by more than the motion of these many periods.
constexpr double kFarthestPeriods = 3.0;

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

std::vector<Eigen::Vector3d> deskewed(const ScanPoints& scan,
                                      std::span<const std::int64_t> times_ns, const Pose& motion,
                                      std::int64_t period_ns) {
  std::vector<Eigen::Vector3d> points_m;
  points_m.reserve(scan.points_m.size());
  const Eigen::Vector3d turn_rad = rotation_vector_of(motion);
  std::optional<std::int64_t> at_ns;  // a column of a spinning sensor shares its time
  Pose moved_by = Pose::Identity();
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    const std::int64_t time_ns = times_ns[scan.rows[i]];
    if (at_ns != time_ns) {
      at_ns = time_ns;
      const double periods = static_cast<double>(time_ns) / static_cast<double>(period_ns);
      const double share = std::clamp(periods, -kFarthestPeriods, kFarthestPeriods);
      moved_by.linear() = rotation_about(share * turn_rad);
      moved_by.translation() = share * motion.translation();
    }
    points_m.push_back(moved(moved_by, scan.points_m[i]));
  }
  return points_m;
}

}  // namespace mosbench::odometry
