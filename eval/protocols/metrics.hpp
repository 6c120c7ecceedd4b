#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "eval/protocols/scan_sums.hpp"

namespace mosbench {

/// Returns one metric, 0..1; nullopt where it is undefined.
std::optional<double> metric_of(const Confusion& counts, Metric metric);

/// Returns tp / (tp + fp + fn), 0..1; nullopt when no point moves, neither in the truth nor in the
/// prediction.
std::optional<double> moving_iou(const Confusion& counts);
/// Returns tp / (tp + fp), 0..1; nullopt when no point is predicted moving.
std::optional<double> precision(const Confusion& counts);
/// Returns tp / (tp + fn), 0..1; nullopt when no truth point moves.
std::optional<double> recall(const Confusion& counts);

/// Metrics of several scans together. Metrics are fractions 0..1.
struct Summary {
  /// Aggregated as the protocol says. A mean of scans is taken over the scans that have a value;
  /// `undefined_scans` is how many have none. A mean of sequences needs a value of each.
  std::array<std::optional<double>, kMetrics.size()> metrics;
  /// Population standard deviation of the scans' IoU, for protocols that average scans.
  std::optional<double> iou_deviation;
  /// The moving IoU of the protocol's own program, with its arithmetic and its value for empty
  /// denominators. In percent if that program prints percent; NaN if it gives NaN.
  double published_iou = 0.0;
  std::string published_text;  ///< as that program prints it: "89.22", "0.000", "nan"
  Confusion pooled;
  std::size_t scans = 0;
  std::size_t undefined_scans = 0;  ///< scans without any moving point, true or predicted

  const std::optional<double>& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

/// Summarises one sequence, or all sequences of a split that the protocol pools.
Summary summarize(const Protocol& protocol, std::span<const Confusion> per_scan);

/// Averages sequences (HeLiMOS's "Avg"): a metric is nullopt when one sequence lacks it.
Summary mean_of_sequences(const Protocol& protocol, std::span<const Summary> sequences);

}  // namespace mosbench
