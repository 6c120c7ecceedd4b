#include "eval/protocols/scan_sums.hpp"

#include <cmath>
#include <limits>

namespace mosbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double value_of(const Ratio& ratio) {
  return ratio.whole > 0.0 ? ratio.part / ratio.whole : kUndefined;
}

using Ratios = std::array<Ratio, kMetrics.size()>;

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

MetricValues aggregate_sums(const Protocol& protocol, std::span<const ScanTerms> sums) {
  if (protocol.aggregation == Aggregation::kMeanOfSequences) {
    std::vector<MetricValues> values;
    for (const ScanTerms& sequence : sums) values.push_back(metrics_of(protocol, sequence));
    return mean_of(values);
  }
  ScanTerms all{};
  for (const ScanTerms& sequence : sums) all += sequence;
  return metrics_of(protocol, all);
}

MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences) {
  std::vector<ScanTerms> sums(sequences.size(), ScanTerms{});
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    for (const Confusion& scan : sequences[s]) sums[s] += scan_terms(protocol, scan);
  }
  return aggregate_sums(protocol, sums);
}

}  // namespace mosbench
