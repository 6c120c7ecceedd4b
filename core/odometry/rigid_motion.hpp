#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mosbench/scan.hpp>

namespace mosbench::odometry {

/// Roll, pitch, yaw in radians, then x, y, z in metres: R = Rz(yaw) Ry(pitch) Rx(roll).
using Angles6 = Eigen::Matrix<double, 6, 1>;

/// Rz(yaw) Ry(pitch) Rx(roll).
inline Eigen::Matrix3d rotation_of(const Angles6& state) {
  const double cr = std::cos(state[0]), sr = std::sin(state[0]);
  const double cp = std::cos(state[1]), sp = std::sin(state[1]);
  const double cy = std::cos(state[2]), sy = std::sin(state[2]);
  Eigen::Matrix3d rotation;
  rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,          //
      -sp, cp * sr, cp * cr;
  return rotation;
}

inline Pose pose_of(const Angles6& state) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation_of(state);
  pose.translation() = state.tail<3>();
  return pose;
}

inline Angles6 angles_of(const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.linear();
  Angles6 state;
  state << std::atan2(rotation(2, 1), rotation(2, 2)),
      std::asin(std::clamp(-rotation(2, 0), -1.0, 1.0)), std::atan2(rotation(1, 0), rotation(0, 0)),
      pose.translation();
  return state;
}

/// The rotation by |v| radians about v.
inline Eigen::Matrix3d rotation_about(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle_rad = rotation_vector_rad.norm();
  if (angle_rad == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, rotation_vector_rad / angle_rad).toRotationMatrix();
}

inline Eigen::Vector3d rotation_vector_of(const Pose& pose) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(pose.linear()).normalized());
  return turn.angle() * turn.axis();
}

/// pose * point, summed from left to right.
inline Eigen::Vector3d moved(const Pose& pose, const Eigen::Vector3d& p) {
  const Eigen::Matrix4d& m = pose.matrix();
  return {m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2) * p.z() + m(0, 3),
          m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2) * p.z() + m(1, 3),
          m(2, 0) * p.x() + m(2, 1) * p.y() + m(2, 2) * p.z() + m(2, 3)};
}

/// Where constant velocity leads to: last * (previous^-1 * last).
inline Pose predicted(const Pose& previous, const Pose& last) {
  Pose next;
  next.matrix() = last.matrix() * (previous.matrix().inverse() * last.matrix());
  return next;
}

/// The nearest rigid pose, without the rounding that products leave. Prediction doubles it every
/// scan.
inline Pose rigid(const Pose& pose) {
  Pose result = Pose::Identity();
  result.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  result.translation() = pose.translation();
  return result;
}

/// `share` of a motion: translation linearly, rotation about its axis. May be negative or beyond 1.
inline Pose part_of(const Pose& motion, double share) {
  Pose part = Pose::Identity();
  part.linear() = rotation_about(share * rotation_vector_of(motion));
  part.translation() = share * motion.translation();
  return part;
}

}  // namespace mosbench::odometry
