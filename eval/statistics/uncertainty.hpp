#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace mosbench {

/// How far judged scans are from one another.
enum class Spacing {
  kNear,  ///< in a row, or nearly: what one shows, the next one shows, too
  kFar,   ///< so far that hardly any two neighbours see the same objects
};

/// With fewer scans in a row nothing is known about how long they stay alike; with fewer scans that
/// are far apart Student's t does not yet hold.
inline constexpr std::size_t kFewestScans = 100, kFewestFarScans = 20;

/// The part of the scans of one sequence in a metric; values per scan.
struct ScanErrors {
  std::vector<double> error;   ///< what the scan adds to the error of the metric
  std::vector<double> weight;  ///< what it counts in the metric, at least 0
  std::vector<double> moving;  ///< moving points
};

/// How uncertain the sum of all errors is.
struct SumUncertainty {
  double standard_error = 0.0;
  double freedom = 0.0;  ///< degrees of freedom of Student's t that the standard error has
  std::string unknown;   ///< why there is none: "60 scans, expected at least 100"; else empty
};

/// Estimates the uncertainty of the sum of all errors, from sequences that are independent of each
/// other. Scans are taken for independent if they are far apart, or if in a row neither errors nor
/// moving points resemble those of the scan before. All others go to `long_run_uncertainty`. If the
/// scans cannot tell, there is no estimate.
SumUncertainty uncertainty_of_sum(std::span<const ScanErrors> sequences, Spacing spacing);

}  // namespace mosbench
