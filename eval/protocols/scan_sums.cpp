#include "eval/protocols/scan_sums.hpp"

#include <cmath>
#include <limits>

namespace mosbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : kUndefined; }

MetricValues metrics_of_counts(double tp, double fp, double fn) {
  return {ratio(tp, tp + fp + fn), ratio(tp, tp + fp), ratio(tp, tp + fn),
          ratio(2.0 * tp, 2.0 * tp + fp + fn)};
}

}  // namespace

MetricValues metrics_of(const Confusion& counts) {
  return metrics_of_counts(static_cast<double>(counts.tp), static_cast<double>(counts.fp),
                           static_cast<double>(counts.fn));
}

MetricValues mean_of(std::span<const MetricValues> values) {
  MetricValues means{};
  for (std::size_t m = 0; m < means.size(); ++m) {
    for (const MetricValues& value : values) means[m] += value[m];
    means[m] = ratio(means[m], static_cast<double>(values.size()));
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

MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums) {
  if (protocol.aggregation != Aggregation::kMeanOfScans) {
    const auto [tp, fp, fn] = std::array{sums[0], sums[1], sums[2]};
    const bool nothing_moves = tp + fn == 0.0;
    if (nothing_moves && protocol.empty_case == EmptyCase::kNanWithoutTruth) {
      return {kUndefined, kUndefined, kUndefined, kUndefined};
    }
    return metrics_of_counts(tp, fp, fn);
  }
  MetricValues values{};
  for (std::size_t m = 0; m < values.size(); ++m) values[m] = ratio(sums[2 * m], sums[2 * m + 1]);
  return values;
}

RunningSums::RunningSums(const Protocol& protocol, const SequenceCounts& scans)
    : sums_(scans.size() + 1, ScanTerms{}) {
  for (std::size_t k = 0; k < scans.size(); ++k) {
    sums_[k + 1] = sums_[k];
    sums_[k + 1] += scan_terms(protocol, scans[k]);
  }
}

void RunningSums::add_range(std::size_t first, std::size_t end, ScanTerms& sums) const {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += sums_[end][i] - sums_[first][i];
}

void RunningSums::add_block(std::size_t first, std::size_t count, ScanTerms& sums) const {
  const std::size_t end = first + count;
  if (end <= scans()) return add_range(first, end, sums);
  add_range(first, scans(), sums);
  add_range(0, end - scans(), sums);
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
