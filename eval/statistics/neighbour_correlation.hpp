#pragma once

#include <span>
#include <vector>

namespace mosbench {

/// Returns the sum of squared deviations from the mean.
double squared_deviations(const std::vector<double>& series);

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

}  // namespace mosbench
