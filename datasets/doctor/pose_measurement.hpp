#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "datasets/doctor/pose_conventions.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Overlap (0 to 1) of scans some metres apart under a convention and under the given poses, on the
/// pairs where the two differ most.
struct ConventionScore {
  std::size_t pairs = 0;  ///< none when the two differ nowhere
  double overlap = 0.0;
  double given_overlap = 0.0;
  std::size_t pairs_better = 0;  ///< where the convention overlaps more
};

/// Overlap of the upright surfaces of scans that are spread over the sequence.
struct PoseFit {
  double overlap = 0.0;
  double best_overlap = 0.0;         ///< after moving the scans to where they overlap best
  double median_correction_m = 0.0;  ///< by which they were moved

  /// Returns false when scans moved elsewhere overlap far better: the poses are not of these scans.
  bool fits() const;
};

/// What overlap says about the poses of a sequence.
struct PoseMeasurement {
  PoseFit given;
  std::vector<ConventionScore> scores;  ///< one per convention that was measured
  /// The conventions that fit better than the given poses, best first. Several when these scans do
  /// not decide between them.
  std::vector<std::size_t> better;
  std::size_t scans_read = 0;
};

/// Reads some dozens of scans, whatever the length of the sequence. Returns nothing when it is too
/// short or its scans have too few points. Throws DataError.
std::optional<PoseMeasurement> measure_poses(const Sequence& sequence,
                                             const std::vector<Pose>& given,
                                             const std::vector<PoseConvention>& conventions);

}  // namespace mosbench
