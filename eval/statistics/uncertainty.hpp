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

/// Correlation of neighbouring values with its standard error.
struct Correlation {
  double value = 0.0;
  double error = 0.0;
  /// Returns the value so many standard errors higher.
  double bound(double errors) const { return value + errors * error; }
};

/// Measures the correlation over all series, without the bias (1 + 3 r) / n of short ones (Kendall
/// 1954). That of equal values is 0.
Correlation neighbour_correlation(std::span<const std::vector<double>> series);

/// Estimates the uncertainty of the sum of all values in `sequences`, consecutive values of
/// stationary series that are independent of each other and remember as long as `measured` says.
/// The variance is the mean square of the first cosine coefficients of each series (Mueller and
/// Watson 2008; Lazarus, Lewis, Stock and Watson 2018), corrected for what an autoregressive
/// process of first order has more power at frequency 0 than at theirs. How many coefficients are
/// taken follows from the correlation of neighbours: those whose frequencies are slower than the
/// series' memory. When even the first two are not, there is no estimate.
SumUncertainty long_run_uncertainty(std::span<const std::vector<double>> sequences,
                                    const Correlation& measured);

}  // namespace mosbench
