#include "eval/protocols/scan_sums.hpp"

#include <limits>

#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : kUndefined; }

void add(const ScanTerms& terms, ScanTerms& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += terms[i];
}

MetricValues pooled_metrics(const Protocol& protocol, const ScanTerms& sums) {
  const auto [tp, fp, fn] = std::array{sums[0], sums[1], sums[2]};
  if (tp + fn == 0.0 && protocol.empty_case == EmptyCase::kNanWithoutTruth) {
    return {kUndefined, kUndefined, kUndefined, kUndefined};
  }
  return {ratio(tp, tp + fp + fn), ratio(tp, tp + fp), ratio(tp, tp + fn),
          ratio(2.0 * tp, 2.0 * tp + fp + fn)};
}

}  // namespace

ScanTerms scan_terms(const Protocol& protocol, const Confusion& scan) {
  if (protocol.aggregation != Aggregation::kMeanOfScans) {
    return {static_cast<double>(scan.tp), static_cast<double>(scan.fp),
            static_cast<double>(scan.fn)};
  }
  ScanTerms terms{};
  const std::array values = {moving_iou(scan), precision(scan), recall(scan), f1(scan)};
  for (std::size_t m = 0; m < values.size(); ++m) {
    if (!values[m]) continue;
    terms[2 * m] = *values[m];
    terms[2 * m + 1] = 1.0;
  }
  return terms;
}

MetricValues metrics_of(const Protocol& protocol, const ScanTerms& sums) {
  if (protocol.aggregation != Aggregation::kMeanOfScans) return pooled_metrics(protocol, sums);
  MetricValues values{};
  for (std::size_t m = 0; m < values.size(); ++m) values[m] = ratio(sums[2 * m], sums[2 * m + 1]);
  return values;
}

RunningSums::RunningSums(const Protocol& protocol, const SequenceCounts& scans)
    : sums_(scans.size() + 1, ScanTerms{}) {
  for (std::size_t k = 0; k < scans.size(); ++k) {
    sums_[k + 1] = sums_[k];
    add(scan_terms(protocol, scans[k]), sums_[k + 1]);
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
    MetricValues means{};
    for (const ScanTerms& sequence : sums) {
      const MetricValues values = metrics_of(protocol, sequence);
      for (std::size_t m = 0; m < means.size(); ++m) {
        means[m] += values[m] / static_cast<double>(sums.size());
      }
    }
    return means;
  }
  ScanTerms all{};
  for (const ScanTerms& sequence : sums) add(sequence, all);
  return metrics_of(protocol, all);
}

MetricValues aggregate(const Protocol& protocol, std::span<const SequenceCounts> sequences) {
  std::vector<ScanTerms> sums(sequences.size(), ScanTerms{});
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    for (const Confusion& scan : sequences[s]) add(scan_terms(protocol, scan), sums[s]);
  }
  return aggregate_sums(protocol, sums);
}

}  // namespace mosbench
