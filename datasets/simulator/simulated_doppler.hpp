#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "datasets/simulator/simulator.hpp"

namespace mosbench {

/// The velocities that an FMCW LiDAR such as the Aeva measures in a scan, exact but for the
/// swinging limbs of pedestrians, who are rigid bodies here.
class SimulatedDoppler {
 public:
  SimulatedDoppler(const Simulator& simulator, std::size_t scan_index);

  /// Returns the velocity of a point that has a return, relative to the sensor and along its ray,
  /// m/s, positive away from the sensor. `scan` is the scan of the constructor's index.
  float radial_velocity_m_s(const SimulatedScan& scan, std::size_t point) const;

 private:
  /// What is a moment after the scan, or before it.
  struct Moment {
    SceneSnapshot scene;
    Eigen::Vector3d sensor_m;
  };
  std::array<Moment, 2> moments_;
};

}  // namespace mosbench
