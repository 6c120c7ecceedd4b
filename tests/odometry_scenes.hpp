#pragma once

#include <cmath>
#include <cstddef>
#include <mosbench/odometry.hpp>
#include <vector>

/// Scans of simple scenes by a spinning sensor, made ray by ray.
namespace mosbench {

struct SceneBox {
  Eigen::Vector3d low, high;
};

/// A floor without end at z = -1.8 m.
std::vector<SceneBox> field();

/// Floor, ceiling and two walls without end along x.
std::vector<SceneBox> corridor();

/// A street: floor, house fronts with gaps, and posts.
std::vector<SceneBox> street();

struct SceneScan {
  std::vector<Point> points;
  std::vector<std::int64_t> point_times_ns;  ///< after the scan's start
};

struct SceneSensor {
  Eigen::Vector3d motion_m = Eigen::Vector3d::Zero();  ///< in its frame within a turn of 0.1 s
  unsigned seed = 1;                                   ///< of the beams' jitter
  int rings = 40, columns = 360;
  /// Beams that are the same in every scan draw rings on the floor that move with the sensor, which
  /// looks as if it stood still.
  double jitter_rad = 0.01;
};

/// One turn of a sensor with beams from -16 to 10 degrees that sees up to 60 m and starts at
/// `start`.
SceneScan scene_scan(const std::vector<SceneBox>& scene, const Pose& start,
                     const SceneSensor& sensor = {});

/// The points of scan `k` of a drive.
std::vector<Point> scene_points(const std::vector<SceneBox>& scene, const Pose& pose, int k);

Pose pose_at(const Eigen::Vector3d& position_m, double yaw_rad);

/// The named kind of odometry with settings changed.
inline std::unique_ptr<Odometry> make_odometry(
    std::string_view name,
    const std::vector<std::pair<std::string_view, SettingValue>>& settings = {},
    unsigned threads = 1) {
  const OdometryKind* kind = find_odometry(name);
  Settings values = kind->defaults;
  for (const auto& [key, value] : settings) values.set(key, value);
  return kind->make(values, threads);
}

inline bool is_finite(const ScanPose& pose) {
  return pose.map_from_sensor.matrix().allFinite() && pose.covariance.allFinite() &&
         std::isfinite(pose.geometry) && std::isfinite(pose.condition) &&
         std::isfinite(pose.overlap);
}

}  // namespace mosbench
