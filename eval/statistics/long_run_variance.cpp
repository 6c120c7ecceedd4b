#include "eval/statistics/long_run_variance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mosbench {
namespace {

using Series = std::vector<double>;

// Chosen by bench/interval_coverage.cpp, whose table is in docs/history/coverage.md.

/// A variance of less than two squares is useless: Student's t is then 12.7. Several sequences have
/// them together: of each the slowest coefficient is enough, and is the least wrong one.
constexpr std::size_t kFewestCoefficients = 2;
/// Shorter ones of several sequences do not show how long scans stay alike.
constexpr double kShortestOfSeveral = 40.0;
/// Coefficients per scan^(2/3), as Lazarus et al. have it with 0.4; fewer of them still hold when
/// the correlation is not that of one autoregressive process.
constexpr double kCoefficients = 0.1;
/// Largest frequency of a coefficient that is taken, in units of the frequency at which the power
/// of the process is half of that at 0.
constexpr double kHighestFrequency = 0.25;
/// The same for the second coefficient, below which no variance is estimated.
constexpr double kHighestFrequencyAtAll = 0.5;
/// The correlation may be larger than measured by this many of its standard errors: when it
/// corrects the variance, and when it decides whether there is one.
constexpr double kSafetyOfVariance = 3.25;
constexpr double kSafetyOfDecision = 2.0;
/// Correlations above are not told from 1.
constexpr double kLongestMemory = 0.995;

double memory_with_safety(const Correlation& measured, double errors) {
  return std::clamp(measured.bound(errors), 0.0, kLongestMemory);
}

/// The frequency in radians per scan at which a process of this correlation has half the power that
/// it has at 0; infinite without correlation.
double corner_frequency(double correlation) { return (1.0 - correlation) / std::sqrt(correlation); }

/// Power of the process at a frequency relative to that at 0.
double relative_power(double correlation, double frequency) {
  const double whole = (1.0 - correlation) * (1.0 - correlation);
  return whole / (1.0 - 2.0 * correlation * std::cos(frequency) + correlation * correlation);
}

/// Returns coefficient `index` from 1 on of the cosine transform with unit norm.
double cosine_coefficient(const Series& series, std::size_t index) {
  const auto scans = static_cast<double>(series.size());
  const double frequency = std::numbers::pi * static_cast<double>(index) / scans;
  double sum = 0.0;
  for (std::size_t k = 0; k < series.size(); ++k) {
    sum += series[k] * std::cos(frequency * (static_cast<double>(k) + 0.5));
  }
  return std::sqrt(2.0 / scans) * sum;
}

std::size_t coefficients_of(std::size_t scans, std::size_t all_scans, double corner,
                            std::size_t sequences) {
  const double most = kCoefficients * std::cbrt(static_cast<double>(all_scans * all_scans)) *
                      static_cast<double>(scans) / static_cast<double>(all_scans);
  const double slow = kHighestFrequency * corner * static_cast<double>(scans) / std::numbers::pi;
  const auto count = static_cast<std::size_t>(std::min(most, slow));
  const std::size_t fewest = sequences == 1 ? kFewestCoefficients : 1;
  return std::max(fewest, count);
}

/// Variance of the sum over one series.
double variance_of_sum(const Series& series, std::size_t coefficients, double correlation) {
  double squares = 0.0;
  double power = 0.0;
  for (std::size_t j = 1; j <= coefficients; ++j) {
    const double coefficient = cosine_coefficient(series, j);
    squares += coefficient * coefficient;
    power += relative_power(correlation, std::numbers::pi * static_cast<double>(j) /
                                             static_cast<double>(series.size()));
  }
  return squares / power * static_cast<double>(series.size());
}

/// Returns why the series are too short for their memory; empty when they are not.
std::string too_short(std::size_t sequences, double mean_scans, const Correlation& measured) {
  if (sequences > 1 && mean_scans < kShortestOfSeveral) {
    return fmt::format("{} sequences of {:.0f} scans in the mean, expected at least {:.0f} in each",
                       sequences, mean_scans, kShortestOfSeveral);
  }
  const double corner = corner_frequency(memory_with_safety(measured, kSafetyOfDecision));
  const double needed = 2.0 * std::numbers::pi / (kHighestFrequencyAtAll * corner);
  if (needed <= mean_scans) return "";
  return fmt::format(
      "neighbouring scans are too alike for {:.0f} per sequence, expected about {:.0f}", mean_scans,
      std::ceil(needed));
}

}  // namespace

SumUncertainty long_run_uncertainty(std::span<const Series> sequences,
                                    const Correlation& measured) {
  std::size_t scans = 0;
  for (const Series& series : sequences) scans += series.size();
  SumUncertainty found;
  found.unknown =
      too_short(sequences.size(),
                static_cast<double>(scans) / static_cast<double>(sequences.size()), measured);
  if (!found.unknown.empty()) return found;
  const double cautious = memory_with_safety(measured, kSafetyOfVariance);
  double variance = 0.0;
  double squares = 0.0;
  double squares_per_freedom = 0.0;
  for (const Series& series : sequences) {
    const std::size_t count =
        coefficients_of(series.size(), scans, corner_frequency(cautious), sequences.size());
    variance += variance_of_sum(series, count, cautious);
    const double share = squared_deviations(series);
    squares += share;
    squares_per_freedom += share * share / static_cast<double>(count);
  }
  found.standard_error = std::sqrt(variance);
  // Satterthwaite 1946, with the spread of the scans in place of the less certain variances.
  found.freedom = squares > 0.0 ? squares * squares / squares_per_freedom : 1.0;
  return found;
}

}  // namespace mosbench
