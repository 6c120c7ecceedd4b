#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/scene_snapshot.hpp"
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

}  // namespace mosbench
