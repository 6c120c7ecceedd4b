#include "eval/statistics/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include "datasets/files/quantile.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/statistics/block_length.hpp"
#include "eval/statistics/distributions.hpp"

namespace mosbench {
namespace {

constexpr double kPower = 0.8;
constexpr double kSignificance = 0.05;
/// A metric that is undefined in a larger share of the replicates gets no interval.
constexpr double kUndefinedShare = 0.05;

using Series = std::vector<double>;
using Sequences = std::span<const SequenceCounts>;

/// Influence of each scan on the IoU; its autocorrelation determines the block length.
Series iou_influence(const Protocol& protocol, const SequenceCounts& scans, double iou) {
  Series series;
  series.reserve(scans.size());
  for (const Confusion& scan : scans) {
    if (protocol.aggregation == Aggregation::kMeanOfScans) {
      series.push_back(moving_iou(scan).value_or(iou) - iou);
    } else {
      series.push_back(static_cast<double>(scan.tp) -
                       iou * static_cast<double>(scan.tp + scan.fp + scan.fn));
    }
  }
  return series;
}

/// One sequence of a run, or of two runs whose scans are drawn together.
struct Drawn {
  std::vector<RunningSums> runs;
  std::size_t block_scans = 1;
};

double or_zero(double value) { return std::isnan(value) ? 0.0 : value; }

std::vector<Drawn> prepare(const Protocol& protocol, std::span<const Sequences> runs) {
  std::vector<Drawn> drawn(runs.front().size());
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    Series influence(runs.front()[s].size(), 0.0);
    double sign = runs.size() == 1 ? 1.0 : -1.0;
    for (const Sequences& run : runs) {
      drawn[s].runs.emplace_back(protocol, run[s]);
      const double iou = or_zero(aggregate(protocol, run.subspan(s, 1))[0]);
      const Series own = iou_influence(protocol, run[s], iou);
      for (std::size_t k = 0; k < own.size(); ++k) influence[k] += sign * own[k];
      sign = 1.0;
    }
    drawn[s].block_scans = block_length(influence);
  }
  return drawn;
}

/// Draws every sequence once; `sums` receives one list of sums per run.
void draw(const std::vector<Drawn>& drawn, std::mt19937_64& random,
          std::vector<std::vector<ScanTerms>>& sums) {
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    for (std::vector<ScanTerms>& run : sums) run[s] = {};
    const std::size_t scans = drawn[s].runs.front().scans();
    for (std::size_t done = 0; done < scans; done += drawn[s].block_scans) {
      // Not std::uniform_int_distribution: its numbers for a seed differ between standard
      // libraries.
      const std::size_t first = random() % scans;
      const std::size_t count = std::min(drawn[s].block_scans, scans - done);
      for (std::size_t r = 0; r < sums.size(); ++r) {
        drawn[s].runs[r].add_block(first, count, sums[r][s]);
      }
    }
  }
}

/// Bootstrap distribution of one number.
struct Distribution {
  Series sorted;
  double standard_error = 0.0;
};

std::optional<Distribution> distribution(Series replicates, std::size_t asked) {
  if (static_cast<double>(replicates.size()) <
      (1.0 - kUndefinedShare) * static_cast<double>(asked)) {
    return std::nullopt;
  }
  std::ranges::sort(replicates);
  double mean = 0.0;
  for (const double value : replicates) mean += value / static_cast<double>(replicates.size());
  double squares = 0.0;
  for (const double value : replicates) squares += (value - mean) * (value - mean);
  return Distribution{
      std::move(replicates),
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, asked - 1)))};
}

/// Correction of the percentile interval for few blocks: its ends are as far out as those of
/// Student's t with `freedom`, not of the normal distribution, and the bootstrap's standard error
/// is too small by the factor `widening`.
struct FewBlocks {
  double freedom = 0.0;
  double widening = 1.0;

  /// Half-width of the interval in standard errors of the bootstrap.
  double half_width(double confidence) const {
    return student_quantile(0.5 + 0.5 * confidence, freedom) * widening;
  }
  /// Share of replicates beyond each end of the interval.
  double tail(double confidence) const { return normal_probability(-half_width(confidence)); }
  /// The significance 1 - confidence of the interval with this share of replicates beyond each end.
  double significance(double tail) const {
    if (tail >= 0.5) return 1.0;
    return 2.0 * student_probability(normal_quantile(tail) / widening, freedom);
  }
};

/// Returns nothing for fewer than two blocks.
std::optional<FewBlocks> few_blocks(const std::vector<Drawn>& drawn) {
  double blocks = 0.0;
  double freedom = 0.0;
  for (const Drawn& sequence : drawn) {
    const auto scans = static_cast<double>(sequence.runs.front().scans());
    if (scans == 0.0) continue;
    blocks += scans / static_cast<double>(sequence.block_scans);
    freedom += scans / static_cast<double>(sequence.block_scans) - 1.0;
  }
  if (freedom < 1.0) return std::nullopt;
  return FewBlocks{freedom, std::sqrt(blocks / (blocks - 1.0))};
}

/// Returns nothing where the ends lie beyond all but the outermost replicate: so few blocks that no
/// number of replicates of them reaches as far as the interval should.
std::optional<Interval> interval_of(const Distribution& distribution, const FewBlocks& blocks,
                                    double confidence) {
  const double tail = blocks.tail(confidence);
  if (tail * static_cast<double>(distribution.sorted.size()) < 1.0) return std::nullopt;
  return Interval{quantile(distribution.sorted, tail, QuantileRule::kInterpolated),
                  quantile(distribution.sorted, 1.0 - tail, QuantileRule::kInterpolated)};
}

/// Sets what is defined.
void set_estimate(double value, const std::optional<Distribution>& spread,
                  const std::optional<FewBlocks>& blocks, double confidence, Estimate& metric) {
  if (std::isnan(value)) return;
  metric.value = value;
  if (!blocks || !spread) return;
  metric.interval = interval_of(*spread, *blocks, confidence);
  if (metric.interval) metric.standard_error = spread->standard_error;
}

/// Returns `replicate(sums)` per metric for each draw; undefined values are left out.
std::array<Series, kMetricNames.size()> replicates(
    const std::vector<Drawn>& drawn, std::size_t runs, const BootstrapOptions& options,
    const std::function<MetricValues(const std::vector<std::vector<ScanTerms>>&)>& replicate) {
  std::array<Series, kMetricNames.size()> series;
  std::vector<std::vector<ScanTerms>> sums(runs, std::vector<ScanTerms>(drawn.size()));
  std::mt19937_64 random(options.seed);
  for (std::size_t i = 0; i < options.replicates; ++i) {
    draw(drawn, random, sums);
    const MetricValues values = replicate(sums);
    for (std::size_t m = 0; m < series.size(); ++m) {
      if (!std::isnan(values[m])) series[m].push_back(values[m]);
    }
  }
  return series;
}

std::vector<std::size_t> block_lengths(const std::vector<Drawn>& drawn) {
  std::vector<std::size_t> lengths;
  for (const Drawn& sequence : drawn) lengths.push_back(sequence.block_scans);
  return lengths;
}

/// The largest q whose interpolated quantile is at most 0.
double share_up_to_zero(std::span<const double> sorted) {
  const auto above = std::ranges::upper_bound(sorted, 0.0);
  if (above == sorted.begin()) return 0.0;
  if (above == sorted.end()) return 1.0;
  const double below = *(above - 1);
  const double position =
      static_cast<double>(above - 1 - sorted.begin()) - below / (*above - below);
  return position / static_cast<double>(sorted.size() - 1);
}

/// Inverts the interval: the significance at which 0 becomes one of its ends. Below it 0 is inside,
/// above it outside, so that interval and p-value never contradict each other.
double p_value(const Distribution& distribution, const FewBlocks& blocks) {
  Series negated;
  for (const double value : distribution.sorted) negated.push_back(-value);
  std::ranges::reverse(negated);
  const double resolution = 1.0 / (1.0 + static_cast<double>(distribution.sorted.size()));
  const double tail = std::min(share_up_to_zero(distribution.sorted), share_up_to_zero(negated));
  return blocks.significance(std::max(tail, resolution));
}

void check_same_scans(Sequences first, Sequences second) {
  bool same = first.size() == second.size();
  for (std::size_t s = 0; same && s < first.size(); ++s) {
    same = first[s].size() == second[s].size();
  }
  if (!same) throw std::invalid_argument("paired_difference: the runs hold different scans");
}

}  // namespace

Estimates estimate(const Protocol& protocol, Sequences sequences, const BootstrapOptions& options) {
  Estimates estimates;
  const std::array runs = {sequences};
  const std::vector<Drawn> drawn = prepare(protocol, runs);
  estimates.block_lengths_scans = block_lengths(drawn);
  const MetricValues values = aggregate(protocol, sequences);
  const std::optional<FewBlocks> blocks = few_blocks(drawn);
  const auto series = replicates(
      drawn, 1, options, [&](const auto& sums) { return aggregate_sums(protocol, sums.front()); });
  for (std::size_t m = 0; m < values.size(); ++m) {
    set_estimate(values[m], distribution(series[m], options.replicates), blocks, options.confidence,
                 estimates.metrics[m]);
  }
  return estimates;
}

Differences paired_difference(const Protocol& protocol, Sequences first, Sequences second,
                              const BootstrapOptions& options) {
  check_same_scans(first, second);
  Differences differences;
  const std::array runs = {first, second};
  const std::vector<Drawn> drawn = prepare(protocol, runs);
  differences.block_lengths_scans = block_lengths(drawn);
  const auto minus = [](MetricValues of, const MetricValues& less) {
    for (std::size_t m = 0; m < of.size(); ++m) of[m] -= less[m];
    return of;
  };
  const MetricValues values = minus(aggregate(protocol, second), aggregate(protocol, first));
  const std::optional<FewBlocks> blocks = few_blocks(drawn);
  const auto series = replicates(drawn, 2, options, [&](const auto& sums) {
    return minus(aggregate_sums(protocol, sums[1]), aggregate_sums(protocol, sums[0]));
  });
  for (std::size_t m = 0; m < values.size(); ++m) {
    Difference& metric = differences.metrics[m];
    const auto spread = distribution(series[m], options.replicates);
    set_estimate(values[m], spread, blocks, options.confidence, metric);
    if (!metric.interval) continue;
    metric.p_value = p_value(*spread, *blocks);
    metric.smallest_detectable =
        (blocks->half_width(1.0 - kSignificance) + normal_quantile(kPower)) *
        spread->standard_error;
  }
  return differences;
}

}  // namespace mosbench
