#pragma once

#include <mosbench/scan.hpp>

namespace mosbench {

/// Returns a pose that is not turned, `x_m` ahead of the origin.
inline Pose pose_at_x(double x_m) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x_m;
  return pose;
}

}  // namespace mosbench
