#include "tests/odometry_scenes.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace mosbench {
namespace {

/// Empty when a ray passes the box.
std::optional<double> range_to(const SceneBox& box, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& direction) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - from[axis]) / direction[axis];
    const double b = (box.high[axis] - from[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter > 0 && enter < leave)) return std::nullopt;
  return enter;
}

}  // namespace

std::vector<SceneBox> field() { return {{{-1e4, -1e4, -3}, {1e4, 1e4, -1.8}}}; }

std::vector<SceneBox> corridor() {
  return {{{-1e4, -1e4, -3}, {1e4, 1e4, -1.2}},
          {{-1e4, -1e4, 1.3}, {1e4, 1e4, 3}},
          {{-1e4, -5, -2}, {1e4, -1.7, 2}},
          {{-1e4, 1.9, -2}, {1e4, 5, 2}}};
}

std::vector<SceneBox> street() {
  std::vector<SceneBox> boxes = field();
  for (int i = -6; i < 10; ++i) {
    const double x = 13.0 * i;
    boxes.push_back({{x, 8, -2}, {x + 9.5, 20, 6}});
    boxes.push_back({{x + 4, -22, -2}, {x + 12, i % 2 == 0 ? -9.0 : -10.0, 5}});
    boxes.push_back({{x + 2.5, 5.5, -2}, {x + 2.9, 5.9, 3}});
    boxes.push_back({{x + 8.5, -6.3, -2}, {x + 8.8, -6, 3}});
  }
  return boxes;
}

SceneScan scene_scan(const std::vector<SceneBox>& scene, const Pose& start,
                     const SceneSensor& sensor) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  std::mt19937 random(sensor.seed);
  const auto jitter = [&] {
    return sensor.jitter_rad * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  SceneScan scan;
  for (int column = 0; column < sensor.columns; ++column) {
    const double share = static_cast<double>(column) / sensor.columns;
    const Eigen::Vector3d from = start * (share * sensor.motion_m);
    for (int ring = 0; ring < sensor.rings; ++ring) {
      const double azimuth = 360 * share * kDegree + jitter();
      const double elevation = (-16 + 26.0 * ring / sensor.rings) * kDegree + jitter();
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      std::optional<double> range;
      for (const SceneBox& box : scene) {
        const auto hit = range_to(box, from, start.linear() * ray);
        if (hit && (!range || *hit < *range)) range = hit;
      }
      if (!range || *range > 60) continue;
      const Eigen::Vector3f p = (ray * *range).cast<float>();
      scan.points.push_back({p.x(), p.y(), p.z(), 0.0F});
      scan.point_times_ns.push_back(static_cast<std::int64_t>(share * 1e8));
    }
  }
  return scan;
}

std::vector<Point> scene_points(const std::vector<SceneBox>& scene, const Pose& pose, int k) {
  return scene_scan(scene, pose, {.seed = static_cast<unsigned>(k) + 1}).points;
}

Pose pose_at(const Eigen::Vector3d& position_m, double yaw_rad) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = position_m;
  return pose;
}

}  // namespace mosbench
