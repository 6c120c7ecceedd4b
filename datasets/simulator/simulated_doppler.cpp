#include "datasets/simulator/simulated_doppler.hpp"

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/simulated_flow.hpp"

namespace mosbench {
namespace {

constexpr std::array kMoments_s = {1e-6, -1e-6};

/// Returns the velocity of the slower way: what begins its way anew just then jumps in the other.
Eigen::Vector3d velocity(const Eigen::Vector3d& later_m, const Eigen::Vector3d& earlier_m,
                         const Eigen::Vector3d& now_m) {
  const Eigen::Vector3d onward = later_m - now_m, hither = now_m - earlier_m;
  return (onward.squaredNorm() <= hither.squaredNorm() ? onward : hither) / kMoments_s[0];
}

/// Whether something moves that stood a moment before, as most does in the first scan.
bool starts(const OwnerState& now, const OwnerState& earlier) {
  return now.speed_m_s > 0.0 && now.base_m == earlier.base_m && now.axis == earlier.axis;
}

}  // namespace

SimulatedDoppler::SimulatedDoppler(const Simulator& simulator, std::size_t scan_index) {
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    moments_[i] = {simulator.scene_at(scan_index, kMoments_s[i]),
                   simulator.map_from_sensor(scan_index, kMoments_s[i]).translation()};
  }
}

float SimulatedDoppler::radial_velocity_m_s(const SimulatedScan& scan, std::size_t point) const {
  const auto& [after, before] = moments_;
  const std::uint32_t owner = scan.owners[point];
  const OwnerState& now = scan.scene.owners[owner];
  const Point& at = scan.points[point];
  const Eigen::Vector3d sensor_m = scan.map_from_sensor.translation();
  const Eigen::Vector3d ray_m = rotated(scan.map_from_sensor.linear(), {at.x, at.y, at.z});
  const Eigen::Vector3d point_m = sensor_m + ray_m;
  const OwnerState& later = after.scene.owners[owner];
  const OwnerState& earlier = before.scene.owners[owner];
  const Eigen::Vector3d later_m = moved_with(now, later, point_m);
  const Eigen::Vector3d of_surface =
      starts(now, earlier) ? Eigen::Vector3d((later_m - point_m) / kMoments_s[0])
                           : velocity(later_m, moved_with(now, earlier, point_m), point_m);
  const Eigen::Vector3d of_sensor = velocity(after.sensor_m, before.sensor_m, sensor_m);
  return static_cast<float>((of_surface - of_sensor).dot(ray_m) / ray_m.norm());
}

}  // namespace mosbench
