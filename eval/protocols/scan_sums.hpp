#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Metrics that are reported with an interval.
enum class Metric : std::size_t { kIou, kPrecision, kRecall, kF1 };
inline constexpr std::array<std::string_view, 4> kMetricNames = {"iou", "precision", "recall",
                                                                 "f1"};

/// Fractions 0..1 by Metric, NaN where undefined.
using MetricValues = std::array<double, kMetricNames.size()>;

/// Moving IoU tp / (tp + fp + fn), precision tp / (tp + fp), recall tp / (tp + fn) and
/// F1 2 tp / (2 tp + fp + fn); NaN where the denominator is 0.
MetricValues metrics_of(const Confusion& counts);

/// Returns the mean of each metric; NaN if any value is NaN, and for an empty list.
MetricValues mean_of(std::span<const MetricValues> values);

/// Counts of the scans of one sequence that have truth, in scan order.
using SequenceCounts = std::vector<Confusion>;

/// Terms that are summed over scans to get a protocol's metrics, so that the metrics of any
/// selection of scans cost one sum. Pooled protocols: tp, fp, fn. Means of scans: per metric the
/// sum of the scans' values and the number of scans that have one.
using ScanTerms = std::array<double, 2 * kMetricNames.size()>;

ScanTerms scan_terms(const Protocol& protocol, const Confusion& scan);
ScanTerms& operator+=(ScanTerms& sums, const ScanTerms& terms);
/// A metric is part / whole; both are sums over scans.
struct Ratio {
  double part, whole;
};
/// Returns the ratio behind each metric of scans whose terms add up to `sums`.
std::array<Ratio, kMetricNames.size()> ratios_of(const Protocol& protocol, const ScanTerms& sums);
/// Returns the metrics of scans whose terms add up to `sums`.
MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums);

/// Returns the metrics of a whole run, aggregated as the protocol says.
MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences);

/// Returns the same from one sum of terms per sequence.
MetricValues aggregate_sums(const Protocol& protocol, std::span<const ScanTerms> sums);

}  // namespace mosbench
