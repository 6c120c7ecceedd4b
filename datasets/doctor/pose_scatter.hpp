#pragma once

#include <mosbench/scan.hpp>
#include <vector>

namespace mosbench {

/// How far poses are from a smooth way, by their positions alone.
struct PoseScatter {
  double noise_m = 0.0;            ///< per axis, if all of it is noise; 0 with too few poses
  double whiteness = 0.0;          ///< third by second differences: sqrt(20 / 6) for white noise
  double acceleration_m_s2 = 0.0;  ///< that a sensor on this way would have, median

  /// Returns whether no sensor moves like this, but noise does.
  bool is_found() const;
};

/// Measures poses that are `step_s` apart.
PoseScatter scatter_of(const std::vector<Pose>& poses, double step_s);

}  // namespace mosbench
