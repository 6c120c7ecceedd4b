#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/measured_motions.hpp"
#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {

/// A way in which the poses of a sequence, or its points, could be stored.
struct PoseConvention {
  std::string name;    ///< "sensor_from_map (inverse)"
  std::string remedy;  ///< what to do if this convention fits
  std::vector<Pose> map_from_sensor;
  /// Brings stored points to what the poses mean: swaps or mirrors axes, or turns the sensor.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  int rows_later = 0;  ///< scan k has the pose of row k + rows_later
  /// Claims that little or nothing moves, which registration falls for where it fails.
  bool stands = false;

  /// Returns the motion that brings stored points of the later scan into the frame of the earlier;
  /// nothing where the rows do not reach.
  std::optional<Pose> motion(const ScanPair& pair) const;
};

/// Returns the conventions other than the given one. `camera_from_lidar` is Tr of calib.txt unless
/// it is the identity, and `applied` says whether the given poses were transformed by it; without
/// Tr the camera is assumed to look along the LiDAR's x axis.
std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied);

/// Returns the given poses shifted by up to `kMostRowsShifted` rows.
std::vector<PoseConvention> shifted_rows(const std::vector<Pose>& given);
inline constexpr int kMostRowsShifted = 15;

/// Returns the scale, the turn of the sensor about each axis, and the lever arm with which the
/// given poses fit the measured motions best; only those large enough to matter.
std::vector<PoseConvention> fitted_corrections(const std::vector<Pose>& given,
                                               const MeasuredMotions& measured);

}  // namespace mosbench
