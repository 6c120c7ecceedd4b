#include "eval/statistics/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mosbench {
namespace {

using Series = std::vector<double>;

double mean_of_values(const Series& series) {
  double mean = 0.0;
  for (const double value : series) mean += value / static_cast<double>(series.size());
  return mean;
}

/// Sum of squared deviations from the mean.
double squared_deviations(const Series& series) {
  const double mean = mean_of_values(series);
  double sum = 0.0;
  for (const double value : series) sum += (value - mean) * (value - mean);
  return sum;
}

double products_of_neighbours(const Series& series) {
  const double mean = mean_of_values(series);
  double sum = 0.0;
  for (std::size_t k = 1; k < series.size(); ++k)
    sum += (series[k] - mean) * (series[k - 1] - mean);
  return sum;
}

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

/// Scans in a row are independent when the correlation of neighbours is surely below: with a
/// probability of 95 %.
constexpr double kSurely = 1.645;
constexpr double kHardlyAlike = 0.25;
/// Scans that are far apart are not independent when their correlation is surely above 0.
constexpr double kSurelyAlike = 2.0;
/// Fewer scans that count as much as others do tell nothing.
constexpr double kFewestThatCount = 6.0;
/// A series of fewer values has no correlation.
constexpr std::size_t kFewestInSequence = 4;

std::vector<Series> all_of(std::span<const ScanErrors> sequences, Series ScanErrors::*series) {
  std::vector<Series> all;
  for (const ScanErrors& sequence : sequences) all.push_back(sequence.*series);
  return all;
}

std::string too_few_scans(std::size_t scans) {
  return fmt::format("{} scans, expected at least {} in a row, or {} that are 10 s apart", scans,
                     kFewestScans, kFewestFarScans);
}

/// Returns the larger correlation of neighbours: of errors, or of moving points. The latter shows
/// how long objects stay in view if other errors hide it.
Correlation memory_of(std::span<const ScanErrors> sequences) {
  const Correlation of_errors = neighbour_correlation(all_of(sequences, &ScanErrors::error));
  const Correlation of_objects = neighbour_correlation(all_of(sequences, &ScanErrors::moving));
  return of_errors.value < of_objects.value ? of_objects : of_errors;
}

/// Returns how many scans of equal weight would tell as much (Kish 1965).
double scans_that_count(std::span<const ScanErrors> sequences) {
  double sum = 0.0, squares = 0.0;
  for (const ScanErrors& sequence : sequences) {
    for (const double weight : sequence.weight) {
      sum += weight;
      squares += weight * weight;
    }
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

SumUncertainty of_independent(std::span<const ScanErrors> sequences) {
  SumUncertainty found;
  double variance = 0.0;
  for (const ScanErrors& sequence : sequences) {
    const auto scans = static_cast<double>(sequence.error.size());
    variance += scans / (scans - 1.0) * squared_deviations(sequence.error);
  }
  found.standard_error = std::sqrt(variance);
  found.freedom =
      std::max(1.0, scans_that_count(sequences) - static_cast<double>(sequences.size()));
  return found;
}

/// Returns why nothing can be told from scans of any correlation; empty when there is no reason.
std::string too_few(std::span<const ScanErrors> sequences) {
  std::size_t scans = 0, shortest = kFewestInSequence;
  for (const ScanErrors& sequence : sequences) {
    scans += sequence.error.size();
    shortest = std::min(shortest, sequence.error.size());
  }
  if (scans < kFewestFarScans) return too_few_scans(scans);
  if (shortest < kFewestInSequence) {
    return fmt::format("a sequence of {} scans, expected at least {}", shortest, kFewestInSequence);
  }
  const double counting = scans_that_count(sequences);
  if (counting >= kFewestThatCount) return "";
  return fmt::format(
      "{:.0f} of {} scans hold nearly all points that count, expected at least {:.0f}",
      std::ceil(counting), scans, kFewestThatCount);
}

}  // namespace

Correlation neighbour_correlation(std::span<const std::vector<double>> series) {
  // Deviations of equal values are rounding, which is alike in neighbours.
  constexpr double kRoundingOfSquares = 1e-24;
  double squares = 0.0, products = 0.0, values = 0.0, rounding = 0.0;
  for (const std::vector<double>& one : series) {
    squares += squared_deviations(one);
    products += products_of_neighbours(one);
    values += static_cast<double>(one.size());
    for (const double value : one) rounding += kRoundingOfSquares * value * value;
  }
  if (!(squares > rounding)) return {0.0, 1.0 / std::sqrt(std::max(values, 1.0))};
  const auto count = static_cast<double>(series.size());
  const double length = values / count;
  const double measured = products / squares * values / (values - count);
  const double value = std::min(1.0, (length * measured + 1.0) / (length - 3.0));
  return {value, std::sqrt(std::max(0.0, 1.0 - value * value) / values)};
}

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

SumUncertainty uncertainty_of_sum(std::span<const ScanErrors> sequences, Spacing spacing) {
  if (const std::string why = too_few(sequences); !why.empty()) return {0.0, 0.0, why};
  std::size_t scans = 0;
  for (const ScanErrors& sequence : sequences) scans += sequence.error.size();
  const bool few = scans < kFewestScans;
  const Correlation memory = memory_of(sequences);
  const bool independent = spacing == Spacing::kFar ? memory.bound(-kSurelyAlike) < 0.0
                                                    : few && memory.bound(kSurely) < kHardlyAlike;
  if (independent) return of_independent(sequences);
  if (few) {
    return {0.0, 0.0,
            spacing == Spacing::kNear
                ? too_few_scans(scans)
                : fmt::format("{} scans that are alike, though far apart, expected at least {}",
                              scans, kFewestScans)};
  }
  return long_run_uncertainty(all_of(sequences, &ScanErrors::error), memory);
}

}  // namespace mosbench
