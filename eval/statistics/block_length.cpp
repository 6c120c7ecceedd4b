#include "eval/statistics/block_length.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mosbench {
namespace {

/// The automatic length minimises the mean squared error of the variance, which it still
/// underestimates. Blocks twice as long give intervals with the promised coverage; the variance is
/// then less certain, which Student's t accounts for.
constexpr double kForCoverage = 2.0;

/// With fewer blocks their variance cannot be estimated.
constexpr std::size_t kFewestBlocks = 6;

/// Autocovariances at lags 0, 1, ... `lags`.
std::vector<double> autocovariances(std::span<const double> series, std::size_t lags) {
  double mean = 0.0;
  for (const double value : series) mean += value;
  mean /= static_cast<double>(series.size());
  std::vector<double> covariances(lags + 1, 0.0);
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    for (std::size_t i = lag; i < series.size(); ++i) {
      covariances[lag] += (series[i] - mean) * (series[i - lag] - mean);
    }
    covariances[lag] /= static_cast<double>(series.size());
  }
  return covariances;
}

/// Returns the smallest lag after which `run` correlations in a row are as small as those of noise.
std::size_t last_correlated_lag(const std::vector<double>& covariances, std::size_t run,
                                double threshold) {
  std::size_t quiet = 0;
  for (std::size_t lag = 1; lag < covariances.size(); ++lag) {
    const bool is_noise = std::abs(covariances[lag]) < threshold * covariances[0];
    quiet = is_noise ? quiet + 1 : 0;
    if (quiet == run) return lag - run;
  }
  return covariances.size() - 1;
}

/// The flat-top window: 1 up to a half, then down to 0 at 1.
double window(double x) { return std::clamp(2.0 * (1.0 - x), 0.0, 1.0); }

}  // namespace

std::size_t block_length(std::span<const double> series) {
  const auto n = static_cast<double>(series.size());
  const std::size_t longest = series.size() / kFewestBlocks;
  if (longest < 2) return 1;
  const auto run = static_cast<std::size_t>(std::max(5.0, std::ceil(std::sqrt(std::log10(n)))));
  const std::size_t lags =
      std::min(series.size() - 1, static_cast<std::size_t>(std::ceil(std::sqrt(n))) + run);
  const std::vector<double> covariances = autocovariances(series, lags);
  if (!(covariances[0] > 0.0)) return 1;
  const std::size_t correlated =
      last_correlated_lag(covariances, run, 2.0 * std::sqrt(std::log10(n) / n));
  const std::size_t bandwidth = std::min(lags, 2 * std::max<std::size_t>(1, correlated));
  double spectrum = covariances[0];
  double slope = 0.0;
  for (std::size_t lag = 1; lag <= bandwidth; ++lag) {
    const double weight = window(static_cast<double>(lag) / static_cast<double>(bandwidth));
    spectrum += 2.0 * weight * covariances[lag];
    slope += 2.0 * weight * static_cast<double>(lag) * covariances[lag];
  }
  if (spectrum == 0.0) return longest;
  // 2 g^2 / D with D = 4/3 g(0)^2.
  const double length = kForCoverage * std::cbrt(1.5 * slope * slope / (spectrum * spectrum) * n);
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(length)), 1, longest);
}

}  // namespace mosbench
