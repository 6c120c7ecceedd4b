#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "datasets/doctor/registration.hpp"
#include "datasets/doctor/scan_overlap.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// How far a motion is from the measured one, in units of what the measurement, or sound poses, may
/// err: squares, so 1 is usual.
struct Misfit {
  double translation = 0.0, rotation = 0.0;
  double both() const { return 0.5 * (translation + rotation); }
};

/// Another motion that two scans may show, alone and put together from scan to scan.
struct OtherMotion {
  Registration registration;
  Pose chained = Pose::Identity();
};

/// The motion between two scans as the scans themselves show it.
struct MeasuredMotion {
  ScanPair pair;
  Pose motion = Pose::Identity();  ///< earlier_from_later
  Matrix6 covariance = Matrix6::Zero();
  double overlap = 0.0, given_overlap = 0.0;
  Pose chained = Pose::Identity();  ///< the same motion, put together from scan to scan
  double back_overlap = 0.0;        ///< under the inverse of the given motion
  OtherMotion back;                 ///< registered from there
  OtherMotion best;                 ///< the largest overlap found, wherever that is

  bool consecutive() const { return pair.later == pair.earlier + 1; }
  /// Against the errors of the measurement.
  Misfit misfit(const Pose& claimed) const;
  /// Against the errors of the measurement and of poses that are still sound.
  Misfit unsound(const Pose& claimed) const;
};

/// Motions over stretches of a sequence: from scan to scan, and between scans some metres apart.
struct MeasuredMotions {
  std::vector<MeasuredMotion> pairs;
  std::size_t scans_read = 0;
};

/// Returns where else to look for the motion between two scans.
using MotionGuess = std::function<std::optional<Pose>(const ScanPair&)>;

/// Registers the scans of short sequences, and of stretches of long ones, with the scan before and
/// with one some metres before. `spots` are scans around which to measure in any case; registration
/// starts from the given motion and from the guesses. Empty when the scans have too few points.
/// Throws DataError.
MeasuredMotions measure_motions(const Sequence& sequence, const std::vector<Pose>& given,
                                const std::vector<std::size_t>& spots,
                                const std::vector<MotionGuess>& guesses = {});

}  // namespace mosbench
