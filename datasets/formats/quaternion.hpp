#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <mosbench/scan.hpp>
#include <optional>

namespace mosbench {

/// Deviation from length 1 that rounding in a text file can cause.
inline constexpr double kQuaternionTolerance = 1e-3;

/// Returns the pose of a translation and a quaternion (x y z w), which is normalized; nothing when
/// a number is not finite or the quaternion is not of length 1.
inline std::optional<Pose> pose_of(const Eigen::Vector3d& translation_m,
                                   const Eigen::Vector4d& xyzw) {
  if (!translation_m.allFinite() || !(std::abs(xyzw.norm() - 1.0) <= kQuaternionTolerance)) {
    return std::nullopt;
  }
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(xyzw).normalized().toRotationMatrix();
  pose.translation() = translation_m;
  return pose;
}

}  // namespace mosbench
