#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "datasets/doctor/pose_conventions.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// How well scans that are some metres apart overlap under a convention, 0 to 1, against the given
/// poses on the same scans, which are those where the two differ most.
struct ConventionScore {
  std::size_t pairs = 0;  ///< none when the two differ nowhere: these poses cannot tell
  double overlap = 0.0;
  double given_overlap = 0.0;
  std::size_t pairs_better = 0;  ///< where the convention overlaps more than the given poses
};

/// How well the upright surfaces of scans spread over the sequence overlap.
struct PoseFit {
  double overlap = 0.0;
  double best_overlap = 0.0;         ///< after moving the scans to where they overlap best
  double median_correction_m = 0.0;  ///< by which they were moved

  /// If not, scans could be moved to fit far better: the poses are not of these scans.
  bool fits() const;
};

/// What overlap says about the poses of a sequence.
struct PoseMeasurement {
  PoseFit given;
  std::vector<ConventionScore> scores;  ///< one per convention that was measured
  /// The conventions that fit where the given poses do not, best first. Several when these scans
  /// cannot tell which of them it is.
  std::vector<std::size_t> better;
  std::size_t scans_read = 0;
};

/// Reads some dozens of scans, whatever the length of the sequence. Nothing when it is too short or
/// its scans are too poor in points to tell. Throws DataError.
std::optional<PoseMeasurement> measure_poses(const Sequence& sequence,
                                             const std::vector<Pose>& given,
                                             const std::vector<PoseConvention>& conventions);

}  // namespace mosbench
