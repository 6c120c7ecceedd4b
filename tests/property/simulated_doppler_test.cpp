#include <gtest/gtest.h>

#include <cmath>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulated_motion.hpp"

namespace mosbench {
namespace {

Eigen::Vector3d ray_in_map(const SimulatedScan& scan, std::size_t point) {
  const Point& p = scan.points[point];
  return (scan.map_from_sensor.linear() * Eigen::Vector3d(p.x, p.y, p.z)).normalized();
}

/// A sensor that stands, and a car that drives along x at 10 m/s, past it and anew every 4 s.
Scene passing_car() {
  Scene scene;
  scene.name = "passing";
  scene.scan_period_s = 0.5;
  scene.ego = {.carrier = Carrier::kTripod, .sensor_height_m = 1.5, .route = {.from_m = {0, 0}}};
  scene.movers = {{.kind = MoverKind::kCar,
                   .route = {.from_m = {15, 0},
                             .legs = {{.to_m = {55, 0}, .speed_m_s = 10}},
                             .after = AfterRoute::kRestart}}};
  return scene;
}

TEST(SimulatedDoppler, OfAStandingSensorIsTheWayThatThingsGoAlongTheRay) {
  const Simulator simulator(passing_car(), sensor_model(SensorKind::kAeva), 1);
  for (const std::size_t k : {0U, 1U, 3U, 8U, 9U}) {  // at 0 its way begins, at 8 anew
    const SimulatedScan scan = simulator.scan(k);
    const SimulatedDoppler doppler(simulator, k);
    std::size_t of_car = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
      const bool is_car = scan.owners[i] == 1;
      of_car += is_car ? 1U : 0U;
      EXPECT_NEAR(doppler.radial_velocity_m_s(scan, i),
                  is_car ? 10.0 * ray_in_map(scan, i).x() : 0.0, 1e-4)
          << k;
    }
    EXPECT_GT(of_car, 20U) << k;
  }
}

/// By two scans a millisecond apart, without the microseconds of the simulator.
TEST(SimulatedDoppler, OfWhatStandsIsThatOfTheSensorBackwards) {
  constexpr double kHalf_s = 5e-4;
  const Simulator simulator(built_in_scene("street"), sensor_model(SensorKind::kAeva), 1);
  const std::size_t k = 7;
  const SimulatedScan scan = simulator.scan(k);
  const SimulatedDoppler doppler(simulator, k);
  const Eigen::Vector3d velocity_m_s = (simulator.map_from_sensor(k, kHalf_s).translation() -
                                        simulator.map_from_sensor(k, -kHalf_s).translation()) /
                                       (2 * kHalf_s);
  EXPECT_GT(velocity_m_s.norm(), 5.0);
  std::size_t standing = 0, moving = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const double of_static = -velocity_m_s.dot(ray_in_map(scan, i));
    const double radial_m_s = double{doppler.radial_velocity_m_s(scan, i)};
    if (scan.scene.owners[scan.owners[i]].speed_m_s > 0) {
      moving += std::abs(radial_m_s - of_static) > 0.5 ? 1U : 0U;
      continue;
    }
    ++standing;
    EXPECT_NEAR(radial_m_s, of_static, 1e-3);
  }
  EXPECT_GT(standing, 10000U);
  EXPECT_GT(moving, 20U);
}

}  // namespace
}  // namespace mosbench
