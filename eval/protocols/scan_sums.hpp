#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// What is reported of a run with an interval.
enum class Metric : std::size_t { kIou, kPrecision, kRecall, kF1 };
inline constexpr std::array<std::string_view, 4> kMetricNames = {"iou", "precision", "recall",
                                                                 "f1"};

/// Fractions 0..1 by Metric, NaN where undefined.
using MetricValues = std::array<double, kMetricNames.size()>;

/// Moving IoU tp / (tp + fp + fn), precision tp / (tp + fp), recall tp / (tp + fn) and
/// F1 2 tp / (2 tp + fp + fn); NaN where the denominator is 0.
MetricValues metrics_of(const Confusion& counts);

/// The plain means of each metric; NaN as soon as one value is, and without any.
MetricValues mean_of(std::span<const MetricValues> values);

/// Counts of the scans of one sequence that have truth, in scan order.
using SequenceCounts = std::vector<Confusion>;

/// What has to be added up over scans to get a protocol's metrics, so that the metrics of any
/// selection of scans cost a sum. Pooled protocols: tp, fp, fn. Means of scans: the sum of the
/// scans' values and how many have one, per metric.
using ScanTerms = std::array<double, 2 * kMetricNames.size()>;

ScanTerms scan_terms(const Protocol& protocol, const Confusion& scan);
ScanTerms& operator+=(ScanTerms& sums, const ScanTerms& terms);
/// The metrics of scans that add up to `sums`.
MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums);

/// Terms of a sequence, summed from its first scan on: the sum of any run of neighbours is one
/// subtraction.
class RunningSums {
 public:
  RunningSums(const Protocol& protocol, const SequenceCounts& scans);

  std::size_t scans() const { return sums_.size() - 1; }
  /// Adds the terms of `count` <= scans() scans from `first` on, going round at the end.
  void add_block(std::size_t first, std::size_t count, ScanTerms& sums) const;

 private:
  void add_range(std::size_t first, std::size_t end, ScanTerms& sums) const;
  std::vector<ScanTerms> sums_;
};

/// The metrics of a whole run as the protocol aggregates scans and sequences.
MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences);

/// The metrics of sequences whose scans add up to `sums`, one each.
MetricValues aggregate_sums(const Protocol& protocol, std::span<const ScanTerms> sums);

}  // namespace mosbench
