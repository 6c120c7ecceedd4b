#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {

/// A convention in which the poses of a sequence, or its points, could be stored.
struct PoseConvention {
  std::string name;    ///< "sensor_from_map (inverse)"
  std::string remedy;  ///< what to do if this convention fits
  std::vector<Pose> map_from_sensor;
  bool swaps_xy = false;     ///< of the points
  bool shifts_rows = false;  ///< by one; the last row is repeated for the missing one

  /// Returns the motion that brings stored points of the later scan into the frame of the earlier.
  Pose motion(const ScanPair& pair) const;
};

/// Returns the conventions other than the given one. `camera_from_lidar` is Tr of calib.txt unless
/// it is the identity, and `applied` says whether the given poses were transformed by it; without
/// Tr the camera is assumed to look along the LiDAR's x axis.
std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied);

}  // namespace mosbench
