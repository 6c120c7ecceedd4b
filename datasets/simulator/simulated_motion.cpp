#include "datasets/simulator/simulated_motion.hpp"

#include <algorithm>
#include <limits>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

/// Whether an owner is elsewhere than its speeds could have brought it.
bool begins_anew(const OwnerState& now, const OwnerState& later, double time_s) {
  constexpr double kSlack_m_s = 1.0, kAcceleration = 1.5;
  const double most_m_s = kAcceleration * std::max(now.speed_m_s, later.speed_m_s) + kSlack_m_s;
  return (later.base_m - now.base_m).norm() > most_m_s * time_s;
}

/// Argoverse 2's numbers of classes.
std::uint8_t class_of(const OwnerState& owner) {
  if (owner.substance != Substance::kMoverBody) return 0;
  switch (owner.mover) {
    case MoverKind::kPedestrian:
      return 17;
    case MoverKind::kCyclist:
      return 4;
    case MoverKind::kCar:
      return 19;
    case MoverKind::kTruck:
      return 25;
  }
  return 0;
}

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

Eigen::Vector3d moved_with(const OwnerState& now, const OwnerState& later,
                           const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d arm = point_m - now.base_m;
  const double cos = now.axis.x() * later.axis.x() + now.axis.y() * later.axis.y();
  const double sin = now.axis.x() * later.axis.y() - now.axis.y() * later.axis.x();
  return later.base_m +
         Eigen::Vector3d(cos * arm.x() - sin * arm.y(), sin * arm.x() + cos * arm.y(), arm.z());
}

void add_motion(const SimulatedScan& scan, std::size_t point, const SceneSnapshot& later,
                double time_s, PointMotions& motions) {
  const std::uint32_t number = scan.owners[point];
  const OwnerState& now = scan.scene.owners[number];
  const OwnerState& then = later.owners[number];
  Eigen::Vector3f velocity_m_s = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  if (!begins_anew(now, then, time_s)) {
    const Point& at = scan.points[point];
    const Eigen::Matrix3d map_from_sensor = scan.map_from_sensor.linear();
    const Eigen::Vector3d point_m =
        rotated(map_from_sensor, {at.x, at.y, at.z}) + scan.map_from_sensor.translation();
    const Eigen::Vector3d way_m = moved_with(now, then, point_m) - point_m;
    velocity_m_s = (rotated(map_from_sensor.transpose(), way_m) / time_s).cast<float>();
  }
  motions.velocities_m_s.push_back(velocity_m_s);
  motions.classes.push_back(class_of(now));
  motions.on_ground.push_back(now.substance == Substance::kGround ? 1 : 0);
}

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
