#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/simulator.hpp"

namespace mosbench {

/// Adds the motion of a point that has a return to those of the points before: that of its owner as
/// a rigid body, the mean over the `time_s` to the snapshot `later`, as data sets compute it from
/// the boxes of two scans. It is not known where the owner begins its way anew meanwhile. On the
/// ground are the points of the scene's ground.
void add_motion(const SimulatedScan& scan, std::size_t point, const SceneSnapshot& later,
                double time_s, PointMotions& motions);

/// Returns where a point of an owner is later, in the map: the owner's bodies are rigid and turn
/// about the vertical through its base.
Eigen::Vector3d moved_with(const OwnerState& now, const OwnerState& later,
                           const Eigen::Vector3d& point_m);

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
