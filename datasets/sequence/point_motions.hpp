#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mosbench {

/// How the points of a scan move until the next one, as data sets of scene flow tell. Each list has
/// one value per point; those that may be empty are where nothing is known.
struct PointMotions {
  /// In the sensor frame of the scan, without the sensor's own motion; NaN where it is not known.
  std::vector<Eigen::Vector3f> velocities_m_s;
  /// Argoverse 2's number of the object's class, 0 for the background; may be empty.
  std::vector<std::uint8_t> classes;
  std::vector<std::uint8_t> on_ground;  ///< 1 or 0; may be empty
  std::vector<std::uint8_t> evaluated;  ///< 1 where the benchmark looks, else 0; may be empty
};

}  // namespace mosbench
