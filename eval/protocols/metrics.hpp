#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Points of scans, added up.
struct CountSums {
  double tp, fp, fn;
};

/// A metric is part / whole; both are sums over scans.
struct Ratio {
  double part, whole;
};

enum class Metric : std::size_t { kIou, kPrecision, kRecall, kF1 };

/// A metric that is reported, a fraction 0..1 with an interval. All that counts, sums up, compares
/// or shows metrics walks the rows.
struct MetricRow {
  std::string_view key;    ///< in JSON, CSV and Python
  std::string_view title;  ///< of a column
  Ratio (*of)(const CountSums& sums);
  std::string_view undefined_where;  ///< the whole is 0
};

/// In the order of Metric.
inline constexpr std::array kMetrics = {
    MetricRow{"iou", "IoU",
              [](const CountSums& n) {
                return Ratio{n.tp, n.tp + n.fp + n.fn};
              },
              "no point that counts moves, in truth or labels"},
    MetricRow{"precision", "precision",
              [](const CountSums& n) {
                return Ratio{n.tp, n.tp + n.fp};
              },
              "no point that counts is labelled moving"},
    MetricRow{"recall", "recall",
              [](const CountSums& n) {
                return Ratio{n.tp, n.tp + n.fn};
              },
              "no point that counts moves"},
    MetricRow{"f1", "F1",
              [](const CountSums& n) {
                return Ratio{2.0 * n.tp, 2.0 * n.tp + n.fp + n.fn};
              },
              "no point that counts moves, in truth or labels"}};

constexpr const MetricRow& row_of(Metric metric) {
  return kMetrics[static_cast<std::size_t>(metric)];
}

/// Of tables that have much else to show: F1 follows from IoU.
inline constexpr std::array kBriefMetrics = {Metric::kIou, Metric::kPrecision, Metric::kRecall};

/// Fractions 0..1 by Metric, NaN where undefined.
using MetricValues = std::array<double, kMetrics.size()>;

/// Returns all metrics; NaN where the whole is 0.
MetricValues metrics_of(const Confusion& counts);

/// Returns the mean of each metric; NaN if any value is NaN, and for an empty list.
MetricValues mean_of(std::span<const MetricValues> values);

/// Counts of the scans of one sequence that have truth, in scan order.
using SequenceCounts = std::vector<Confusion>;

/// Terms that are summed over scans to get a protocol's metrics, so that the metrics of any
/// selection of scans cost one sum. Pooled protocols: tp, fp, fn. Means of scans: per metric the
/// sum of the scans' values and the number of scans that have one.
using ScanTerms = std::array<double, 2 * kMetrics.size()>;

ScanTerms scan_terms(const Protocol& protocol, const Confusion& scan);
ScanTerms& operator+=(ScanTerms& sums, const ScanTerms& terms);
/// Returns the ratio behind each metric of scans whose terms add up to `sums`.
std::array<Ratio, kMetrics.size()> ratios_of(const Protocol& protocol, const ScanTerms& sums);
/// Returns the metrics of scans whose terms add up to `sums`.
MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums);

/// Returns the metrics of a whole run, aggregated as the protocol says.
MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences);

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
  MetricValues metrics{};
  /// Population standard deviation of the scans' IoU, for protocols that average scans.
  std::optional<double> iou_deviation;
  /// The moving IoU of the protocol's own program, with its arithmetic and its value for empty
  /// denominators. In percent if that program prints percent; NaN if it gives NaN.
  double published_iou = 0.0;
  std::string published_text;  ///< as that program prints it: "89.22", "0.000", "nan"
  Confusion pooled;
  std::size_t scans = 0;
  std::size_t undefined_scans = 0;  ///< scans without any moving point, true or predicted

  /// Returns nullopt where the metric is undefined.
  std::optional<double> operator[](Metric metric) const;
};

/// Returns the points per scan that are called moving and are not; nullopt without scans. Defined
/// where the IoU is not, because nothing moves.
std::optional<double> false_positives_per_scan(const Summary& summary);

/// Summarises one sequence, or all sequences of a split that the protocol pools.
Summary summarize(const Protocol& protocol, std::span<const Confusion> per_scan);

/// Averages sequences (HeLiMOS's "Avg"): a metric is nullopt when one sequence lacks it.
Summary mean_of_sequences(const Protocol& protocol, std::span<const Summary> sequences);

/// Returns {"tp", "fp", "fn", "tn", "ignored"}, the names that every JSON of the program uses.
nlohmann::ordered_json counts_json(const Confusion& counts);

/// Returns {"protocol", "min_range_m", "max_range_m"}; `name` is the first member's.
nlohmann::ordered_json rule_json(const ScoreRule& rule, const char* name = "protocol");

/// Fractions 0..1, null where undefined; counts are those of all scans together.
nlohmann::ordered_json to_json(const Summary& summary);

}  // namespace mosbench
