#include "core/odometry/deskew.hpp"

#include <algorithm>
#include <optional>

#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

// No point is moved by more than the motion of these many periods.
constexpr double kFarthestPeriods = 3.0;

}  // namespace

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
