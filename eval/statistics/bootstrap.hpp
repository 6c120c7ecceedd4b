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

/// Options of the bootstrap. The same options and scans give the same intervals on every machine.
struct BootstrapOptions {
  std::size_t replicates = 2000;
  std::uint64_t seed = 1;
  double confidence = 0.95;
};

/// A metric with its uncertainty.
struct Estimate {
  std::optional<double> value;           ///< fraction; nullopt where undefined
  std::optional<double> standard_error;  ///< of the bootstrap
  std::optional<Interval> interval;      ///< nullopt for fewer than about five blocks of scans
};

/// The four metrics of a run, by Metric.
struct Estimates {
  std::array<Estimate, kMetricNames.size()> metrics;
  std::vector<std::size_t> block_lengths_scans;  ///< per sequence
  const Estimate& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Estimates intervals by a circular block bootstrap: scans are drawn with replacement within each
/// sequence, in blocks of `block_length` consecutive scans. Percentile intervals, widened for few
/// blocks by the ratio of Student's t to the normal distribution (Hesterberg 2015). Too few blocks,
/// of which no replicate reaches that far, give no interval.
Estimates estimate(const Protocol& protocol, std::span<const SequenceCounts> sequences,
                   const BootstrapOptions& options = {});

/// One metric of a second run minus that of a first on the same scans.
struct Difference : Estimate {
  std::optional<double> p_value;  ///< two-sided; below 1 - confidence exactly where 0 is outside
                                  ///< the interval; never below what the replicates resolve
  /// The true difference that as many scans like these show at 5 % significance with 80 %
  /// probability; with n times the scans it is smaller by the square root of n.
  std::optional<double> smallest_detectable;
};

struct Differences {
  std::array<Difference, kMetricNames.size()> metrics;
  std::vector<std::size_t> block_lengths_scans;
  const Difference& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Estimates the paired difference: each replicate draws the same scans of both runs. `first` and
/// `second` hold the same scans in the same order; throws std::invalid_argument otherwise.
Differences paired_difference(const Protocol& protocol, std::span<const SequenceCounts> first,
                              std::span<const SequenceCounts> second,
                              const BootstrapOptions& options = {});

}  // namespace mosbench
