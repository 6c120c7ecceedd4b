#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/convention_scores.hpp"
#include "datasets/doctor/pose_scatter.hpp"

namespace mosbench {

/// What the motions that the scans show say about the poses.
struct PoseDiagnosis {
  std::size_t scans_read = 0;
  double overlap = 0.0;       ///< of upright surfaces, median
  double best_overlap = 0.0;  ///< after moving the scans to where they overlap best
  double median_correction_m = 0.0;
  /// Mean square deviation of the given poses from the measured motions, in units of poses with
  /// noise of 5 cm and 0.1 degrees. Each motion counts up to 25.
  double unsound = 0.0;
  bool fits = false;  ///< unsound is small: the scans confirm the poses
  /// The same of measured motions put together from scan to scan, against those over metres: how
  /// well motions can be measured here, without regard to the poses.
  double disagreement = 0.0;
  std::vector<PoseConvention> conventions;
  std::vector<ConventionScore> scores;  ///< one per convention
  std::vector<std::string> findings;    ///< plain sentences
  std::vector<std::string> remarks;     ///< of what may well be right
  /// Flags that read the poses as they are meant, "--pose-frame lidar"; empty where none do.
  std::string flags;
  /// Of how smooth the way of the given poses is.
  PoseScatter scatter;
  std::map<std::string, double> measures;  ///< what thresholds are compared with
};

/// What is known of the scans besides their points.
struct ScanSteps {
  std::vector<std::string> stems;
  std::optional<double> step_s;  ///< median time from scan to scan
};

/// Compares the poses with the motions that scans show.
PoseDiagnosis diagnose(const std::vector<Pose>& given, const MeasuredMotions& measured,
                       std::vector<PoseConvention> conventions, const ScanSteps& scans);

}  // namespace mosbench
