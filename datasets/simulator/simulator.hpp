#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/scene_cast.hpp"
#include "datasets/simulator/sensor_model.hpp"

namespace mosbench {

/// One instantaneous scan with everything known about it. One point per ray in firing order; a ray
/// without return is (0,0,0,0) and belongs to `kNoReturn`.
struct SimulatedScan {
  static constexpr std::uint32_t kNoReturn = 0xFFFFFFFF;

  std::vector<Point> points;
  std::vector<std::uint32_t> owners;  ///< per point, an index into `scene.owners` or kNoReturn
  SceneSnapshot scene;
  Pose map_from_sensor = Pose::Identity();
  std::int64_t stamp_ns = 0;

  /// Of a point that has a return.
  SimulatedReturn at(std::size_t point) const {
    return {points[point], scene.owners[owners[point]], owners[point]};
  }
};

/// Ray casting of a scene by one sensor. A scan depends on nothing but scene, sensor, seed and its
/// index: the same bits on every machine, in any order, from any number of threads.
class Simulator {
 public:
  /// Values of the scene for the sensor (noise, columns) override the model's.
  Simulator(Scene scene, const SensorModel& sensor, std::uint64_t seed);

  SimulatedScan scan(std::size_t scan_index) const;

  /// Returns the scan as a reader would: every ray kept, truth 251 for moving, 9 for static, and 0
  /// where there is no return or no label.
  Frame frame(std::size_t scan_index) const;

  /// Return pose and stamp of a scan without computing its points; the pose some seconds later.
  Pose map_from_sensor(std::size_t scan_index, double later_s = 0.0) const;
  std::int64_t stamp_ns(std::size_t scan_index) const;
  /// Returns the scene as that scan sees it, or some seconds later.
  SceneSnapshot scene_at(std::size_t scan_index, double later_s = 0.0) const;

  const SensorModel& sensor() const { return sensor_; }
  const Scene& scene() const { return scene_; }

 private:
  double time_s(std::size_t scan_index) const;

  Scene scene_;
  SensorModel sensor_;
  std::uint64_t seed_;
  std::vector<Eigen::Vector3d> directions_;  // of sensors that repeat every scan
};

/// Returns a simulator of a built-in scene and the sensor of that name. Throws UsageError for
/// unknown names.
Simulator built_in_simulator(std::string_view scene, std::string_view sensor, std::uint64_t seed);

}  // namespace mosbench
