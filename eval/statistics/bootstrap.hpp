#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eval/protocols/scan_sums.hpp"

namespace mosbench {

struct Interval {
  double low, high;
  bool operator==(const Interval&) const = default;
};

/// How a bootstrap is drawn. The same options and scans give the same intervals everywhere.
struct BootstrapOptions {
  std::size_t replicates = 2000;
  std::uint64_t seed = 1;
  double confidence = 0.95;
};

/// A metric with what its scans tell about its accuracy.
struct Estimate {
  std::optional<double> value;           ///< fraction; nothing where undefined
  std::optional<double> standard_error;  ///< of the bootstrap
  std::optional<Interval> interval;  ///< nothing with fewer than two independent blocks of scans
};

/// The four metrics of a run, by Metric.
struct Estimates {
  std::array<Estimate, kMetricNames.size()> metrics;
  std::vector<std::size_t> block_lengths_scans;  ///< per sequence
  const Estimate& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Intervals by drawing scans with replacement, each sequence by itself and in circular blocks of
/// neighbours as long as its autocorrelation asks (see `block_length`). Percentile intervals,
/// widened for few blocks as Student's t is against the normal distribution (Hesterberg 2015).
Estimates estimate(const Protocol& protocol, std::span<const SequenceCounts> sequences,
                   const BootstrapOptions& options = {});

/// One metric of a second run minus that of a first on the same scans.
struct Difference : Estimate {
  std::optional<double> p_value;  ///< two-sided, of "the runs are equally good"
  /// The true difference that scans like these would show at 5 % significance with a probability
  /// of 80 %; for n times the scans divide by the root of n.
  std::optional<double> smallest_detectable;
};

struct Differences {
  std::array<Difference, kMetricNames.size()> metrics;
  std::vector<std::size_t> block_lengths_scans;
  const Difference& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// The paired difference: both runs are drawn with the same scans. `first` and `second` hold the
/// same scans in the same order; throws std::invalid_argument otherwise.
Differences paired_difference(const Protocol& protocol, std::span<const SequenceCounts> first,
                              std::span<const SequenceCounts> second,
                              const BootstrapOptions& options = {});

}  // namespace mosbench
