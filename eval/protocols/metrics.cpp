#include "eval/protocols/metrics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

namespace mosbench {
namespace {

std::optional<double> ratio(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

using Metric = std::optional<double> (*)(const Confusion&);

/// The values of those scans that have one.
std::vector<double> defined_values(std::span<const Confusion> scans, Metric metric) {
  std::vector<double> values;
  for (const Confusion& scan : scans) {
    if (const std::optional<double> value = metric(scan)) values.push_back(*value);
  }
  return values;
}

std::optional<double> mean(std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::optional<double> population_deviation(std::span<const double> values) {
  const std::optional<double> centre = mean(values);
  if (!centre) return std::nullopt;
  double squares = 0.0;
  for (const double value : values) squares += (value - *centre) * (value - *centre);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Nothing as soon as one of the values is nothing.
std::optional<double> mean_of_all(std::span<const Summary> sequences,
                                  std::optional<double> Summary::*metric) {
  std::vector<double> values;
  for (const Summary& sequence : sequences) {
    if (!(sequence.*metric)) return std::nullopt;
    values.push_back(*(sequence.*metric));
  }
  return mean(values);
}

/// Whether the protocol's own program finds anything to divide by.
bool has_value(const Protocol& protocol, const Confusion& counts) {
  const bool truth_moves = counts.tp + counts.fn > 0;
  return truth_moves || (counts.fp > 0 && protocol.empty_case != EmptyCase::kNanWithoutTruth);
}

double published_value_of_nothing(EmptyCase empty_case) {
  switch (empty_case) {
    case EmptyCase::kOne:
      return 1.0;
    case EmptyCase::kEpsilon:
      return 0.0;
    case EmptyCase::kNan:
    case EmptyCase::kNanWithoutTruth:
      break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double published_ratio(const Protocol& protocol, const Confusion& counts) {
  if (!has_value(protocol, counts)) return published_value_of_nothing(protocol.empty_case);
  const std::uint64_t all = counts.tp + counts.fp + counts.fn;
  if (protocol.metric_arithmetic == Arithmetic::kFloat) {
    return static_cast<double>(static_cast<float>(counts.tp) / static_cast<float>(all));
  }
  // Rounding loses the epsilon from a denominator of 16 on, not below.
  const double epsilon = protocol.empty_case == EmptyCase::kEpsilon ? 1e-15 : 0.0;
  return static_cast<double>(counts.tp) / (static_cast<double>(all) + epsilon);
}

/// What is left of a scan's value in the file from which the program averages.
double as_in_file(const Protocol& protocol, double value) {
  if (protocol.file_significant_digits == 0) return value;
  return std::stod(fmt::format("{:.{}g}", value, protocol.file_significant_digits));
}

std::string print(double value, const PrintStyle& style) {
  if (std::isnan(value)) return "nan";
  return style.significant ? fmt::format("{:.{}g}", value, style.digits)
                           : fmt::format("{:.{}f}", value, style.digits);
}

double published_iou(const Protocol& protocol, std::span<const Confusion> scans,
                     const Confusion& pooled) {
  const double unit = protocol.program_print.percent ? 100.0 : 1.0;
  if (protocol.aggregation != Aggregation::kMeanOfScans) {
    return published_ratio(protocol, pooled) * unit;
  }
  double sum = 0.0;
  for (const Confusion& scan : scans) {
    sum += as_in_file(protocol, published_ratio(protocol, scan)) * unit;
  }
  return sum / static_cast<double>(scans.size());
}

}  // namespace

std::optional<double> moving_iou(const Confusion& counts) {
  return ratio(counts.tp, counts.tp + counts.fp + counts.fn);
}

std::optional<double> precision(const Confusion& counts) {
  return ratio(counts.tp, counts.tp + counts.fp);
}

std::optional<double> recall(const Confusion& counts) {
  return ratio(counts.tp, counts.tp + counts.fn);
}

std::optional<double> f1(const Confusion& counts) {
  return ratio(2 * counts.tp, 2 * counts.tp + counts.fp + counts.fn);
}

Summary summarize(const Protocol& protocol, std::span<const Confusion> per_scan) {
  Summary summary;
  summary.scans = per_scan.size();
  for (const Confusion& scan : per_scan) {
    summary.pooled += scan;
    if (!moving_iou(scan)) ++summary.undefined_scans;
  }
  if (protocol.aggregation == Aggregation::kMeanOfScans) {
    const std::vector<double> ious = defined_values(per_scan, moving_iou);
    summary.iou = mean(ious);
    summary.iou_deviation = population_deviation(ious);
    summary.precision = mean(defined_values(per_scan, precision));
    summary.recall = mean(defined_values(per_scan, recall));
    summary.f1 = mean(defined_values(per_scan, f1));
  } else if (has_value(protocol, summary.pooled)) {
    summary.iou = moving_iou(summary.pooled);
    summary.precision = precision(summary.pooled);
    summary.recall = recall(summary.pooled);
    summary.f1 = f1(summary.pooled);
  }
  summary.published_iou = published_iou(protocol, per_scan, summary.pooled);
  summary.published_text = print(summary.published_iou, protocol.program_print);
  return summary;
}

Summary mean_of_sequences(const Protocol& protocol, std::span<const Summary> sequences) {
  Summary average;
  double published_sum = 0.0;
  for (const Summary& sequence : sequences) {
    average.pooled += sequence.pooled;
    average.scans += sequence.scans;
    average.undefined_scans += sequence.undefined_scans;
    published_sum += sequence.published_iou;
  }
  average.iou = mean_of_all(sequences, &Summary::iou);
  average.precision = mean_of_all(sequences, &Summary::precision);
  average.recall = mean_of_all(sequences, &Summary::recall);
  average.f1 = mean_of_all(sequences, &Summary::f1);
  average.published_iou = published_sum / static_cast<double>(sequences.size());
  average.published_text = print(average.published_iou, protocol.program_print);
  return average;
}

std::string format_value(const Protocol& protocol, std::optional<double> value) {
  if (!value) return "undefined";
  return protocol.print.percent ? print(*value * 100.0, protocol.print) + " %"
                                : print(*value, protocol.print);
}

}  // namespace mosbench
