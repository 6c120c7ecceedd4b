#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {

/// One way in which the poses of a sequence, or its points, could be meant.
struct PoseConvention {
  std::string name;    ///< "sensor_from_map (inverse)"
  std::string remedy;  ///< what to do if it is the one that fits
  std::vector<Pose> map_from_sensor;
  bool swaps_xy = false;     ///< of the points
  bool shifts_rows = false;  ///< by one; the last one stands for what is beyond the end

  /// By which points of the later scan come into the frame of the earlier one, as they are stored.
  Pose motion(const ScanPair& pair) const;
};

/// The conventions other than the given one. `camera_from_lidar` is Tr of calib.txt when there is
/// one other than the identity, and `applied` tells whether the given poses were turned by it;
/// without Tr the camera is taken to look along the lidar's x axis.
std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied);

}  // namespace mosbench
