#include "datasets/simulator/simulated_flow.hpp"

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

}  // namespace mosbench
