#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "eval/protocols/metrics.hpp"
#include "eval/statistics/uncertainty.hpp"

namespace mosbench {

/// Distribution function of Student's t with `freedom` >= 1 degrees of freedom.
double student_probability(double t, double freedom);
/// Quantile of Student's t with `freedom` >= 1 degrees of freedom, which need not be whole;
/// `probability` in (0, 1).
double student_quantile(double probability, double freedom);

/// Confidence of all intervals that are printed.
inline constexpr double kConfidence = 0.95;

struct Interval {
  double low, high;
  bool operator==(const Interval&) const = default;
};

/// A metric with its uncertainty.
struct Estimate {
  std::optional<double> value;           ///< fraction; nullopt where undefined
  std::optional<double> standard_error;  ///< nullopt without interval
  std::optional<Interval> interval;      ///< within 0..1; of a difference within -1..1
  std::string no_interval;  ///< why there is none; empty with an interval or without value
};

/// The four metrics of a run, by Metric.
struct Estimates {
  std::array<Estimate, kMetrics.size()> metrics;
  const Estimate& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Estimates how far the metrics would be from those of many more scans like these. The metric is
/// linear in small changes of its sums, so that its error is a sum over scans (delta method), whose
/// standard error `uncertainty_of_sum` estimates; the interval is Student's t. There is none where
/// these scans cannot tell.
Estimates estimate(const Protocol& protocol, std::span<const SequenceCounts> sequences,
                   Spacing spacing = Spacing::kNear, double confidence = kConfidence);

/// Returns the estimate of a single seed; of several their mean, and by Student's t of their spread
/// where that of many more seeds would be. `interval` stays in `within`.
Estimate mean_of_estimates(std::span<const Estimate> seeds, const Interval& within);

/// One metric of a second run minus that of a first on the same scans.
struct Difference : Estimate {
  /// Two-sided, of the same Student's t as the interval: below 1 - confidence exactly where 0 is
  /// outside the interval. nullopt without interval.
  std::optional<double> p_value;
  /// The true difference that as many scans like these show at 5 % significance with 80 %
  /// probability; with n times the scans it is smaller by the square root of n.
  std::optional<double> smallest_detectable;
};

/// Makes a difference of a value, and of the errors whose sum is how far it may be off. The
/// interval stays in `within`.
Difference difference_of(double value, std::span<const ScanErrors> errors, Spacing spacing,
                         const Interval& within, double confidence = kConfidence);

struct Differences {
  std::array<Difference, kMetrics.size()> metrics;
  const Difference& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Estimates the paired difference: what both runs share on a scan cancels. `first` and `second`
/// hold the same scans in the same order; throws std::invalid_argument otherwise.
Differences paired_difference(const Protocol& protocol, std::span<const SequenceCounts> first,
                              std::span<const SequenceCounts> second,
                              Spacing spacing = Spacing::kNear, double confidence = kConfidence);

}  // namespace mosbench
