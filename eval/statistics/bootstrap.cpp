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

/// Half-width of the interval in standard errors, corrected for few blocks: Student's t for their
/// number, and the bootstrap's variance is too small by (blocks - 1) / blocks. nullopt for fewer
/// than two blocks.
std::optional<double> half_width(const std::vector<Drawn>& drawn, double confidence) {
  double blocks = 0.0;
  double freedom = 0.0;
  for (const Drawn& sequence : drawn) {
    const auto scans = static_cast<double>(sequence.runs.front().scans());
    if (scans == 0.0) continue;
    blocks += scans / static_cast<double>(sequence.block_scans);
    freedom += scans / static_cast<double>(sequence.block_scans) - 1.0;
  }
  if (freedom < 1.0) return std::nullopt;
  return student_quantile(0.5 + 0.5 * confidence, freedom) * std::sqrt(blocks / (blocks - 1.0));
}

Interval interval_of(const Distribution& distribution, double ends) {
  const double tail = normal_probability(-ends);
  return {quantile(distribution.sorted, tail, QuantileRule::kInterpolated),
          quantile(distribution.sorted, 1.0 - tail, QuantileRule::kInterpolated)};
}

/// Sets what is defined; `ends` is a half_width().
void set_estimate(double value, const std::optional<Distribution>& spread,
                  const std::optional<double>& ends, Estimate& metric) {
  if (std::isnan(value)) return;
  metric.value = value;
  if (!ends || !spread) return;
  metric.standard_error = spread->standard_error;
  metric.interval = interval_of(*spread, *ends);
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

double p_value(const Distribution& distribution, double value, double widening) {
  if (value == 0.0) return 1.0;
  std::size_t beyond = 0;
  for (const double replicate : distribution.sorted) {
    // A replicate that equals the value up to rounding counts as beyond it.
    if (std::abs(replicate - value) * widening >= std::abs(value) * (1.0 - 1e-9)) ++beyond;
  }
  return (1.0 + static_cast<double>(beyond)) /
         (1.0 + static_cast<double>(distribution.sorted.size()));
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
  const std::optional<double> ends = half_width(drawn, options.confidence);
  const auto series = replicates(
      drawn, 1, options, [&](const auto& sums) { return aggregate_sums(protocol, sums.front()); });
  for (std::size_t m = 0; m < values.size(); ++m) {
    set_estimate(values[m], distribution(series[m], options.replicates), ends,
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
  const std::optional<double> ends = half_width(drawn, options.confidence);
  const std::optional<double> significant = half_width(drawn, 1.0 - kSignificance);
  const double widening = ends.value_or(0.0) / normal_quantile(0.5 + 0.5 * options.confidence);
  const auto series = replicates(drawn, 2, options, [&](const auto& sums) {
    return minus(aggregate_sums(protocol, sums[1]), aggregate_sums(protocol, sums[0]));
  });
  for (std::size_t m = 0; m < values.size(); ++m) {
    Difference& metric = differences.metrics[m];
    const auto spread = distribution(series[m], options.replicates);
    set_estimate(values[m], spread, ends, metric);
    if (!metric.interval) continue;
    metric.p_value = p_value(*spread, values[m], widening);
    metric.smallest_detectable = (*significant + normal_quantile(kPower)) * spread->standard_error;
  }
  return differences;
}

}  // namespace mosbench
