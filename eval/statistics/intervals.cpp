#include "eval/statistics/intervals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>  // nowhere else: it takes a second to compile
#include <cmath>
#include <stdexcept>
#include <vector>

namespace mosbench {
namespace {

constexpr double kPower = 0.8;
constexpr double kSignificance = 0.05;

using Sequences = std::span<const SequenceCounts>;

ScanTerms sum_of(const Protocol& protocol, const SequenceCounts& scans) {
  ScanTerms sums{};
  for (const Confusion& scan : scans) sums += scan_terms(protocol, scan);
  return sums;
}

/// Returns by how much the sum of `scans` errors is larger without a scan that has this share in
/// the metric (jackknife). The metric follows scans of much weight, so their part of the error
/// would be too small.
double leverage(double scans, double share) {
  return share < 1.0 ? (scans - 1.0) / scans / (1.0 - share) : 1.0;
}

/// Returns what each scan adds to the error of a metric, (part - value * whole) / sum of whole.
/// `metric` is defined.
std::vector<ScanErrors> scan_errors(const Protocol& protocol, Sequences sequences,
                                    std::size_t metric) {
  const bool by_sequence = protocol.aggregation == Aggregation::kMeanOfSequences;
  ScanTerms all{};
  double all_scans = 0.0;
  for (const SequenceCounts& scans : sequences) {
    all += sum_of(protocol, scans);
    all_scans += static_cast<double>(scans.size());
  }
  const double part_of_all = by_sequence ? 1.0 / static_cast<double>(sequences.size()) : 1.0;
  std::vector<ScanErrors> errors;
  for (const SequenceCounts& scans : sequences) {
    if (scans.empty()) continue;
    const Ratio sum = ratios_of(protocol, by_sequence ? sum_of(protocol, scans) : all)[metric];
    const double count = by_sequence ? static_cast<double>(scans.size()) : all_scans;
    ScanErrors& own = errors.emplace_back();
    for (const Confusion& scan : scans) {
      const Ratio ratio = ratios_of(protocol, scan_terms(protocol, scan))[metric];
      const double share = ratio.whole / sum.whole;
      own.error.push_back(part_of_all * leverage(count, share) *
                          (ratio.part - sum.part / sum.whole * ratio.whole) / sum.whole);
      own.weight.push_back(part_of_all * share);
      own.moving.push_back(static_cast<double>(scan.tp + scan.fn));
    }
  }
  return errors;
}

/// Sets everything but the value and returns how uncertain it is.
SumUncertainty set_interval(std::span<const ScanErrors> errors, Spacing spacing,
                            const Interval& within, double confidence, Estimate& metric) {
  SumUncertainty found = uncertainty_of_sum(errors, spacing);
  metric.no_interval = found.unknown;
  if (!found.unknown.empty()) return found;
  const double half =
      student_quantile(0.5 + 0.5 * confidence, found.freedom) * found.standard_error;
  metric.standard_error = found.standard_error;
  metric.interval = Interval{std::max(within.low, *metric.value - half),
                             std::min(within.high, *metric.value + half)};
  return found;
}

/// Makes of the errors of two metrics those of the second minus the first.
void subtract(const std::vector<ScanErrors>& first, std::vector<ScanErrors>& second) {
  for (std::size_t s = 0; s < second.size(); ++s) {
    for (std::size_t k = 0; k < second[s].error.size(); ++k) {
      second[s].error[k] -= first[s].error[k];
      second[s].weight[k] += first[s].weight[k];
    }
  }
}

/// Probability under no difference of one at least as large.
double p_value(double difference, const SumUncertainty& found) {
  if (difference == 0.0) return 1.0;
  if (found.standard_error == 0.0) return 0.0;
  return 2.0 * student_probability(-std::abs(difference) / found.standard_error, found.freedom);
}

void check_same_scans(Sequences first, Sequences second) {
  bool same = first.size() == second.size();
  for (std::size_t s = 0; same && s < first.size(); ++s) {
    same = first[s].size() == second[s].size();
  }
  if (!same) throw std::invalid_argument("paired_difference: the runs hold different scans");
}

}  // namespace

double student_probability(double t, double freedom) {
  return boost::math::cdf(boost::math::students_t(freedom), t);
}

double student_quantile(double probability, double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), probability);
}

Estimates estimate(const Protocol& protocol, Sequences sequences, Spacing spacing,
                   double confidence) {
  Estimates estimates;
  const MetricValues values = aggregate(protocol, sequences);
  for (std::size_t m = 0; m < values.size(); ++m) {
    if (std::isnan(values[m])) continue;
    Estimate& metric = estimates.metrics[m];
    metric.value = values[m];
    set_interval(scan_errors(protocol, sequences, m), spacing, {0.0, 1.0}, confidence, metric);
  }
  return estimates;
}

Estimate mean_of_estimates(std::span<const Estimate> seeds, const Interval& within) {
  constexpr std::size_t kFewest = 3;  // of two, Student's t spans more than there is
  if (seeds.size() == 1) return seeds.front();
  const bool defined =
      std::ranges::all_of(seeds, [](const auto& seed) { return seed.value.has_value(); });
  if (seeds.empty() || !defined) return {};
  const double count = static_cast<double>(seeds.size());
  double sum = 0.0, squares = 0.0;
  for (const Estimate& seed : seeds) sum += *seed.value;
  const double mean = sum / count;
  if (seeds.size() < kFewest) {
    return {mean, {}, {}, fmt::format("{} seeds, expected at least {}", seeds.size(), kFewest)};
  }
  for (const Estimate& seed : seeds) squares += (*seed.value - mean) * (*seed.value - mean);
  const double error = std::sqrt(squares / (count - 1.0) / count);
  const double half = student_quantile(0.5 + 0.5 * kConfidence, count - 1.0) * error;
  const Interval interval{std::max(within.low, mean - half), std::min(within.high, mean + half)};
  return {mean, error, interval, ""};
}

Difference difference_of(double value, std::span<const ScanErrors> errors, Spacing spacing,
                         const Interval& within, double confidence) {
  Difference difference;
  difference.value = value;
  const SumUncertainty found = set_interval(errors, spacing, within, confidence, difference);
  if (!difference.interval) return difference;
  difference.p_value = p_value(value, found);
  difference.smallest_detectable = (student_quantile(1.0 - 0.5 * kSignificance, found.freedom) +
                                    student_quantile(kPower, found.freedom)) *
                                   found.standard_error;
  return difference;
}

Differences paired_difference(const Protocol& protocol, Sequences first, Sequences second,
                              Spacing spacing, double confidence) {
  check_same_scans(first, second);
  Differences differences;
  const MetricValues before = aggregate(protocol, first);
  const MetricValues after = aggregate(protocol, second);
  for (std::size_t m = 0; m < before.size(); ++m) {
    if (std::isnan(before[m]) || std::isnan(after[m])) continue;
    std::vector<ScanErrors> change = scan_errors(protocol, second, m);
    subtract(scan_errors(protocol, first, m), change);
    differences.metrics[m] =
        difference_of(after[m] - before[m], change, spacing, {-1.0, 1.0}, confidence);
  }
  return differences;
}

}  // namespace mosbench
