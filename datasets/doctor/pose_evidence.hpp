#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/measured_motions.hpp"
#include "datasets/doctor/pose_conventions.hpp"

namespace mosbench {

/// A motion that is off by less (squared, in units of sound noise) fits.
inline constexpr double kFitting = 4.0;

/// The given poses of a sequence beside the motions that its scans show.
struct PoseEvidence {
  const std::vector<Pose>& given;
  const std::vector<MeasuredMotion>& pairs;
  const std::vector<std::string>& stems;  ///< names of the scans
  /// How far off the best convention is, in units of the registration's errors, at least 1: the
  /// noise of the poses.
  double noise = 1.0;
  double disagreement = 0.0;  ///< see PoseDiagnosis

  Pose given_motion(const MeasuredMotion& pair) const { return relative(given, pair.pair); }
  /// Returns how unlikely (log) a claimed motion is.
  double unlikeliness(const MeasuredMotion& pair, const Pose& claimed) const;
  /// Returns how far the given motion is off, in units of sound noise.
  double off(const MeasuredMotion& pair) const;

  template <typename Value>
  double median_over(Value&& value, bool only_steps = false) const {
    std::vector<double> values;
    for (const MeasuredMotion& pair : pairs) {
      if (!only_steps || pair.consecutive()) values.push_back(value(pair));
    }
    return values.empty() ? 0.0 : median(std::move(values));
  }

  /// Returns the mean square deviation of claimed motions from measured ones, in units of poses
  /// with sound noise. `motion_of` returns nothing for pairs that are left out.
  template <typename MotionOf>
  double unsound(MotionOf&& motion_of) const {
    // A motion counts at most so much, so that few do not decide.
    constexpr double kMostUnsound = 25.0;
    double translation = 0.0, rotation = 0.0, count = 0.0;
    for (const MeasuredMotion& pair : pairs) {
      const std::optional<Pose> claimed = motion_of(pair);
      if (!claimed) continue;
      const Misfit misfit = pair.unsound(*claimed);
      translation += std::min(misfit.translation, kMostUnsound);
      rotation += std::min(misfit.rotation, kMostUnsound);
      count += 1.0;
    }
    return std::max(translation, rotation) / std::max(count, 1.0);
  }
};

}  // namespace mosbench
