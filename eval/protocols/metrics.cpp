#include "eval/protocols/metrics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace mosbench {
namespace {

using Ratios = std::array<Ratio, kMetrics.size()>;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double value_of(const Ratio& ratio) {
  return ratio.whole > 0.0 ? ratio.part / ratio.whole : kUndefined;
}

Ratios ratios_of(const CountSums& sums) {
  Ratios ratios{};
  for (std::size_t m = 0; m < ratios.size(); ++m) ratios[m] = kMetrics[m].of(sums);
  return ratios;
}

MetricValues values_of(const Ratios& ratios) {
  MetricValues values{};
  for (std::size_t m = 0; m < values.size(); ++m) values[m] = value_of(ratios[m]);
  return values;
}

std::optional<double> value_in(const MetricValues& values, Metric metric) {
  const double value = values[static_cast<std::size_t>(metric)];
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// Population standard deviation of the IoU of those scans that have one.
double iou_deviation(std::span<const Confusion> scans, double mean) {
  double squares = 0.0;
  double defined_scans = 0.0;
  for (const Confusion& scan : scans) {
    if (const std::optional<double> iou = moving_iou(scan)) {
      squares += (*iou - mean) * (*iou - mean);
      defined_scans += 1.0;
    }
  }
  return std::sqrt(squares / defined_scans);
}

/// Whether the denominator of the protocol's own program is not 0.
bool has_value(const Protocol& protocol, const Confusion& counts) {
  const bool truth_moves = counts.tp + counts.fn > 0;
  return truth_moves || (counts.fp > 0 && protocol.empty_case != EmptyCase::kNanWithoutTruth);
}

double published_ratio(const Protocol& protocol, const Confusion& counts) {
  const bool is_epsilon = protocol.empty_case == EmptyCase::kEpsilon;
  if (!has_value(protocol, counts)) {
    return protocol.empty_case == EmptyCase::kOne ? 1.0 : is_epsilon ? 0.0 : kUndefined;
  }
  const std::uint64_t all = counts.tp + counts.fp + counts.fn;
  if (protocol.metric_arithmetic == Arithmetic::kFloat) {
    return static_cast<double>(static_cast<float>(counts.tp) / static_cast<float>(all));
  }
  // Rounding loses an epsilon of 1e-15 from a denominator of 16 on, not below.
  const double epsilon = is_epsilon ? protocol.epsilon : 0.0;
  return static_cast<double>(counts.tp) / (static_cast<double>(all) + epsilon);
}

/// Rounds a scan's value as in the file that the protocol's own program averages.
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

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nullptr;
}

}  // namespace

MetricValues metrics_of(const Confusion& counts) {
  return values_of(ratios_of({static_cast<double>(counts.tp), static_cast<double>(counts.fp),
                              static_cast<double>(counts.fn)}));
}

MetricValues mean_of(std::span<const MetricValues> values) {
  MetricValues means{};
  for (std::size_t m = 0; m < means.size(); ++m) {
    for (const MetricValues& value : values) means[m] += value[m];
    means[m] = value_of({means[m], static_cast<double>(values.size())});
  }
  return means;
}

ScanTerms scan_terms(const Protocol& protocol, const Confusion& scan) {
  if (protocol.aggregation != Aggregation::kMeanOfScans) {
    return {static_cast<double>(scan.tp), static_cast<double>(scan.fp),
            static_cast<double>(scan.fn)};
  }
  ScanTerms terms{};
  const MetricValues values = metrics_of(scan);
  for (std::size_t m = 0; m < values.size(); ++m) {
    if (std::isnan(values[m])) continue;
    terms[2 * m] = values[m];
    terms[2 * m + 1] = 1.0;
  }
  return terms;
}

ScanTerms& operator+=(ScanTerms& sums, const ScanTerms& terms) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += terms[i];
  return sums;
}

std::array<Ratio, kMetrics.size()> ratios_of(const Protocol& protocol, const ScanTerms& sums) {
  if (protocol.aggregation != Aggregation::kMeanOfScans) {
    return ratios_of({sums[0], sums[1], sums[2]});
  }
  Ratios ratios{};
  for (std::size_t m = 0; m < ratios.size(); ++m) ratios[m] = {sums[2 * m], sums[2 * m + 1]};
  return ratios;
}

MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums) {
  const bool pooled = protocol.aggregation != Aggregation::kMeanOfScans;
  const bool nothing_moves = pooled && sums[0] + sums[2] == 0.0;
  if (nothing_moves && protocol.empty_case == EmptyCase::kNanWithoutTruth) {
    MetricValues none;
    none.fill(kUndefined);
    return none;
  }
  return values_of(ratios_of(protocol, sums));
}

MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences) {
  ScanTerms all{};
  std::vector<MetricValues> values;
  for (const SequenceCounts& scans : sequences) {
    ScanTerms sums{};
    for (const Confusion& scan : scans) sums += scan_terms(protocol, scan);
    all += sums;
    values.push_back(metrics_of(protocol, sums));
  }
  return protocol.aggregation == Aggregation::kMeanOfSequences ? mean_of(values)
                                                               : metrics_of(protocol, all);
}

std::optional<double> metric_of(const Confusion& counts, Metric metric) {
  return value_in(metrics_of(counts), metric);
}

std::optional<double> moving_iou(const Confusion& counts) {
  return metric_of(counts, Metric::kIou);
}

std::optional<double> precision(const Confusion& counts) {
  return metric_of(counts, Metric::kPrecision);
}

std::optional<double> recall(const Confusion& counts) { return metric_of(counts, Metric::kRecall); }

std::optional<double> Summary::operator[](Metric metric) const { return value_in(metrics, metric); }

Summary summarize(const Protocol& protocol, std::span<const Confusion> per_scan) {
  Summary summary;
  summary.scans = per_scan.size();
  ScanTerms sums{};
  for (const Confusion& scan : per_scan) {
    summary.pooled += scan;
    sums += scan_terms(protocol, scan);
    if (!moving_iou(scan)) ++summary.undefined_scans;
  }
  summary.metrics = metrics_of(protocol, sums);
  if (protocol.aggregation == Aggregation::kMeanOfScans && summary[Metric::kIou]) {
    summary.iou_deviation = iou_deviation(per_scan, *summary[Metric::kIou]);
  }
  summary.published_iou = published_iou(protocol, per_scan, summary.pooled);
  summary.published_text = print(summary.published_iou, protocol.program_print);
  return summary;
}

Summary mean_of_sequences(const Protocol& protocol, std::span<const Summary> sequences) {
  Summary average;
  double published_sum = 0.0;
  std::vector<MetricValues> values;
  for (const Summary& sequence : sequences) {
    values.push_back(sequence.metrics);
    average.pooled += sequence.pooled;
    average.scans += sequence.scans;
    average.undefined_scans += sequence.undefined_scans;
    published_sum += sequence.published_iou;
  }
  average.metrics = mean_of(values);
  average.published_iou = published_sum / static_cast<double>(sequences.size());
  average.published_text = print(average.published_iou, protocol.program_print);
  return average;
}

std::optional<double> false_positives_per_scan(const Summary& summary) {
  if (summary.scans == 0) return std::nullopt;
  return static_cast<double>(summary.pooled.fp) / static_cast<double>(summary.scans);
}

nlohmann::ordered_json counts_json(const Confusion& counts) {
  return {{"tp", counts.tp},
          {"fp", counts.fp},
          {"fn", counts.fn},
          {"tn", counts.tn},
          {"ignored", counts.ignored}};
}

nlohmann::ordered_json rule_json(const ScoreRule& rule, const char* name) {
  return {{name, std::string(rule.protocol->name)},
          {"min_range_m", rule.range.min_m},
          {"max_range_m", rule.range.max_m}};
}

nlohmann::ordered_json to_json(const Summary& summary) {
  nlohmann::ordered_json json;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json[std::string(kMetrics[m].key)] = number(summary.metrics[m]);
  }
  json["iou_deviation"] = number(summary.iou_deviation);
  json["published_iou"] = number(summary.published_iou);
  json["published_text"] = summary.published_text;
  json.update(counts_json(summary.pooled));
  json["false_positives_per_scan"] = number(false_positives_per_scan(summary));
  json["unknown_ids"] = summary.pooled.unknown_ids;
  json["labelled_scans"] = summary.scans;
  json["undefined_scans"] = summary.undefined_scans;
  return json;
}

}  // namespace mosbench
