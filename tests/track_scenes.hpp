#pragma once

#include <cmath>
#include <memory>
#include <mosbench/method.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/small_world.hpp"

/// Scenes of boxes on level ground, cast ray by ray at 10 Hz, for what judges whole tracks.
namespace mosbench::tracks {

/// A box that goes at a constant velocity.
struct Walker {
  Box box;  ///< at the first scan, metres
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
};

struct TrackScene {
  std::vector<Walker> things;
  Eigen::Vector3d sensor_velocity_m_s = Eigen::Vector3d::Zero();
  int scans = 60;
};

/// A scan and the thing that each of its points lies on; -1 is the ground or the wall.
struct SceneScan {
  std::vector<Point> points;
  std::vector<int> thing;
  Pose map_from_sensor = Pose::Identity();
};

/// Rays 0.5 degrees apart, from 1.5 m above the ground, in a room of 40 m.
inline SceneScan cast(const TrackScene& scene, int k) {
  SceneScan scan;
  const double t_s = 0.1 * k;
  const Eigen::Vector3d from = Eigen::Vector3d(0, 0, 1.5) + t_s * scene.sensor_velocity_m_s;
  scan.map_from_sensor.translation() = from;
  const Box room{{-20, -20, 0}, {20, 20, 10}};
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 360; ++column) {
      const double down = (row * 0.5 + 0.25) * std::numbers::pi / 180;
      const double turn = (column + 0.5) * 0.5 * std::numbers::pi / 180 - std::numbers::pi / 2;
      const Eigen::Vector3d ray(std::cos(down) * std::cos(turn), std::cos(down) * std::sin(turn),
                                -std::sin(down));
      double range = distance_to(room, from, ray, true);
      int hit = -1;
      for (std::size_t i = 0; i < scene.things.size(); ++i) {
        Box box = scene.things[i].box;
        box.low += t_s * scene.things[i].velocity_m_s;
        box.high += t_s * scene.things[i].velocity_m_s;
        const double distance = distance_to(box, from, ray, false);
        if (distance >= range) continue;
        range = distance;
        hit = static_cast<int>(i);
      }
      const Eigen::Vector3f point = (range * ray).cast<float>();
      scan.points.push_back({point.x(), point.y(), point.z(), 0});
      scan.thing.push_back(hit);
    }
  }
  return scan;
}

/// Calls points moving as it is told for the next scan, with a delay of no scan.
class ToldMethod final : public Method {
 public:
  std::vector<std::vector<std::uint32_t>> labels;  ///< by scan

  std::unique_ptr<Observed> observe(std::span<const Point>, const Pose&,
                                    const RayOrigins&) override {
    return std::make_unique<Observed>();
  }
  std::vector<LabelledScan> push(std::unique_ptr<Observed>) override {
    std::vector<LabelledScan> scans(1);
    scans.front().scan_index = next_;
    scans.front().labels = labels.at(next_++);
    return scans;
  }

 private:
  std::size_t next_ = 0;
};

/// A box of a person, whose middle is at (x, y).
inline Box person(double x, double y) {
  return {{x - 0.25, y - 0.25, 0.05}, {x + 0.25, y + 0.25, 1.8}};
}

}  // namespace mosbench::tracks
