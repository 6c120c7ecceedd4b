#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/scan.hpp"
#include "datasets/sequence.hpp"

namespace mosbench {

/// One way in which the poses of a sequence, or its points, could be meant.
struct PoseConvention {
  std::string name;    ///< "sensor_from_map (inverse)"
  std::string remedy;  ///< what to do if it is the one that fits
  std::vector<Pose> map_from_sensor;
  bool swaps_xy = false;  ///< of the points
};

/// The conventions other than the given one. `camera_from_lidar` is Tr of calib.txt when there is
/// one other than the identity, and `applied` tells whether the given poses were turned by it;
/// without Tr the camera is taken to look along the lidar's x axis.
std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied);

/// How well scans that are a few apart overlap under a convention, 0 to 1, against the given poses
/// on the same scans, which are those where the two differ most.
struct ConventionScore {
  std::size_t convention = 0;  ///< in the list that was measured
  std::size_t pairs = 0;
  double overlap = 0.0;
  double given_overlap = 0.0;
  std::size_t pairs_better = 0;  ///< where the convention overlaps more than the given poses

  /// Whether the convention fits and the given one does not.
  bool beats_given() const;
};

/// What overlap says about the poses of a sequence.
struct PoseMeasurement {
  std::vector<ConventionScore> scores;  ///< of conventions that differ from the given on some scans
  double given_overlap = 0.0;           ///< on scans spread over the sequence
  double best_overlap = 0.0;            ///< there, after moving the scans to where they fit best
  double median_correction_m = 0.0;     ///< by which they were moved
  std::size_t scans_read = 0;

  /// Whether an overlap is near what moving the scans reaches.
  bool is_full(double overlap) const;
  /// If not, scans could be moved to fit far better: the poses are not of these scans.
  bool given_fits() const;
};

/// Reads some dozens of scans, whatever the length of the sequence. Nothing when it is too short or
/// its scans are too poor in points to tell. Throws DataError.
std::optional<PoseMeasurement> measure_poses(const Sequence& sequence,
                                             const std::vector<Pose>& given,
                                             const std::vector<PoseConvention>& conventions);

}  // namespace mosbench
