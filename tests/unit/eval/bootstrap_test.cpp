#include "eval/statistics/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "eval/protocols/metrics.hpp"
#include "eval/statistics/block_length.hpp"
#include "eval/statistics/distributions.hpp"

namespace mosbench {
namespace {

Confusion counts(std::uint64_t tp, std::uint64_t fp, std::uint64_t fn) {
  Confusion confusion;
  confusion.tp = tp;
  confusion.fp = fp;
  confusion.fn = fn;
  return confusion;
}

/// Standard normal numbers, the same with every library.
class Normal {
 public:
  explicit Normal(unsigned seed) : random_(seed) {}
  double operator()() {
    const double u = (static_cast<double>(random_()) + 0.5) / 4294967296.0;
    const double v = (static_cast<double>(random_()) + 0.5) / 4294967296.0;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  }

 private:
  std::mt19937 random_;
};

/// Scans of 1000 moving points each whose recall wanders as an autoregressive process.
SequenceCounts wandering_scans(Normal& normal, std::size_t scans, double memory, double share) {
  SequenceCounts sequence;
  double state = normal();
  for (std::size_t k = 0; k < scans; ++k) {
    state = memory * state + std::sqrt(1.0 - memory * memory) * normal();
    const double found = std::clamp(share + 0.1 * state, 0.0, 1.0);
    const auto tp = static_cast<std::uint64_t>(std::lround(1000.0 * found));
    sequence.push_back(counts(tp, 0, 1000 - tp));
  }
  return sequence;
}

std::vector<double> autoregressive(unsigned seed, std::size_t scans, double memory) {
  Normal normal(seed);
  std::vector<double> series = {normal()};
  while (series.size() < scans) series.push_back(memory * series.back() + normal());
  return series;
}

// The numbers are of printed tables and of mpmath with 30 digits.
TEST(Distributions, EqualTheTables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-9);
  EXPECT_NEAR(normal_quantile(0.8), 0.8416212335729143, 1e-9);
  EXPECT_NEAR(normal_probability(-1.0), 0.15865525393145705, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 1.0), 12.706204736174698, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 9.0), 2.262157162798205, 1e-9);
  EXPECT_NEAR(student_quantile(0.025, 30.0), -2.0422724563012378, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 1e6), 1.9599663566, 1e-9);
  // Tangent, the inverse of the distribution function at one degree of freedom; t^2 = 2 q^2 / (1 -
  // q^2) at two.
  for (const double q : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(student_quantile(0.5 + 0.5 * q, 1.0), std::tan(0.5 * std::numbers::pi * q), 1e-9);
    EXPECT_NEAR(student_quantile(0.5 + 0.5 * q, 2.0), q * std::sqrt(2.0 / (1.0 - q * q)), 1e-9);
  }
}

TEST(BlockLength, IsOneForNoiseAndGrowsWithTheMemory) {
  double noise = 0.0;
  double slow = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    noise += static_cast<double>(block_length(autoregressive(seed, 400, 0.0))) / 20.0;
    slow += static_cast<double>(block_length(autoregressive(seed, 400, 0.9))) / 20.0;
  }
  EXPECT_LT(noise, 5.0);
  EXPECT_GT(slow, 20.0);
  EXPECT_EQ(block_length(std::vector<double>(100, 3.0)), 1U);
  EXPECT_EQ(block_length(std::vector<double>{1.0, 2.0, 3.0}), 1U);
  EXPECT_EQ(block_length({}), 1U);
}

TEST(Estimate, GivesTheValuesOfTheTable) {
  std::mt19937 random(5);
  for (const Protocol& protocol : protocols()) {
    std::vector<SequenceCounts> sequences(3);
    std::vector<Summary> summaries;
    SequenceCounts all;
    for (SequenceCounts& sequence : sequences) {
      for (int k = 0; k < 7; ++k) {
        sequence.push_back(counts(random() % 50 + 1, random() % 20, random() % 20));
      }
      sequence.push_back(counts(0, 0, 0));
      summaries.push_back(summarize(protocol, sequence));
      all.insert(all.end(), sequence.begin(), sequence.end());
    }
    const Summary summary = protocol.aggregation == Aggregation::kMeanOfSequences
                                ? mean_of_sequences(protocol, summaries)
                                : summarize(protocol, all);
    const Estimates estimates = estimate(protocol, sequences);
    EXPECT_NEAR(estimates[Metric::kIou].value.value(), summary.iou.value(), 1e-12) << protocol.name;
    EXPECT_NEAR(estimates[Metric::kPrecision].value.value(), summary.precision.value(), 1e-12);
    EXPECT_NEAR(estimates[Metric::kRecall].value.value(), summary.recall.value(), 1e-12);
    EXPECT_NEAR(estimates[Metric::kF1].value.value(), summary.f1.value(), 1e-12);
    EXPECT_TRUE(estimates[Metric::kIou].interval.has_value());
  }
}

TEST(Estimate, IsUndefinedWithoutPointsAndHasNoIntervalForOneScan) {
  const Protocol& protocol = protocol_named("sipailou");
  const std::vector<SequenceCounts> nothing = {{counts(0, 0, 0), counts(0, 0, 0)}};
  EXPECT_FALSE(estimate(protocol, nothing)[Metric::kIou].value);
  EXPECT_FALSE(estimate(protocol, std::vector<SequenceCounts>{{}})[Metric::kIou].value);
  const std::vector<SequenceCounts> one = {{counts(3, 0, 1)}};
  EXPECT_DOUBLE_EQ(estimate(protocol, one)[Metric::kIou].value.value(), 0.75);
  EXPECT_FALSE(estimate(protocol, one)[Metric::kIou].interval);
}

TEST(Estimate, GivesTheSameIntervalAgain) {
  Normal normal(3);
  const std::vector<SequenceCounts> run = {wandering_scans(normal, 60, 0.8, 0.6)};
  const Protocol& protocol = protocol_named("sipailou");
  EXPECT_EQ(estimate(protocol, run)[Metric::kIou].interval,
            estimate(protocol, run)[Metric::kIou].interval);
}

/// How many of the intervals of many simulated runs hold the true recall.
double coverage(const char* protocol, std::size_t scans, double memory) {
  constexpr int kRuns = 300;
  int covered = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    Normal normal(seed);
    const std::vector<SequenceCounts> run = {wandering_scans(normal, scans, memory, 0.6)};
    const Estimates estimates = estimate(protocol_named(protocol), run, {.replicates = 500});
    const Interval interval = estimates[Metric::kIou].interval.value();
    if (interval.low <= 0.6 && 0.6 <= interval.high) ++covered;
  }
  return covered / static_cast<double>(kRuns);
}

// 300 runs give a share of 95 % with a standard deviation of 1.3 %. A block bootstrap of scans with
// a long memory covers somewhat less than it says; drawing them one by one covers far less.
TEST(Estimate, CoversTheTruthAsOftenAsItSays) {
  EXPECT_NEAR(coverage("sipailou", 20, 0.0), 0.95, 0.035) << "20 independent scans";
  EXPECT_NEAR(coverage("doals-hmm", 10, 0.0), 0.95, 0.04) << "10 independent scans";
  EXPECT_NEAR(coverage("sipailou", 200, 0.7), 0.935, 0.045) << "neighbours alike";
  EXPECT_NEAR(coverage("doals-hmm", 200, 0.7), 0.935, 0.045) << "neighbours alike";
}

TEST(PairedDifference, OfARunWithItselfIsNothing) {
  Normal normal(1);
  const std::vector<SequenceCounts> run = {wandering_scans(normal, 50, 0.5, 0.6)};
  const Difference iou = paired_difference(protocol_named("sipailou"), run, run)[Metric::kIou];
  EXPECT_EQ(iou.value, 0.0);
  EXPECT_EQ(iou.interval, (Interval{0.0, 0.0}));
  EXPECT_EQ(iou.p_value, 1.0);
  EXPECT_EQ(iou.smallest_detectable, 0.0);
}

TEST(PairedDifference, FindsASmallChangeThatTheRunsIntervalsHide) {
  Normal normal(1);
  const std::vector<SequenceCounts> before = {wandering_scans(normal, 50, 0.5, 0.6)};
  std::vector<SequenceCounts> after = before;
  for (std::size_t k = 0; k < after[0].size(); ++k) {
    const std::uint64_t lost = 8 + k % 5;
    after[0][k].tp -= lost;
    after[0][k].fn += lost;
  }
  const Protocol& protocol = protocol_named("sipailou");
  const Difference iou = paired_difference(protocol, before, after)[Metric::kIou];
  EXPECT_NEAR(iou.value.value(), -0.01, 1e-9);
  EXPECT_LT(iou.interval.value().high, 0.0);
  EXPECT_LT(iou.p_value.value(), 0.03) << "the least that few blocks resolve";
  EXPECT_LT(iou.smallest_detectable.value(), 0.01);
  const Interval alone = estimate(protocol, after)[Metric::kIou].interval.value();
  EXPECT_GT(alone.high, aggregate(protocol, before)[0]) << "intervals of each run overlap";
}

TEST(PairedDifference, CallsEqualRunsDifferentInOneOfTwenty) {
  constexpr int kPairs = 300;
  int significant = 0;
  int outside = 0;
  for (unsigned seed = 1; seed <= kPairs; ++seed) {
    Normal normal(seed);
    const std::vector<SequenceCounts> first = {wandering_scans(normal, 60, 0.5, 0.6)};
    const std::vector<SequenceCounts> second = {wandering_scans(normal, 60, 0.5, 0.6)};
    const Difference iou = paired_difference(protocol_named("sipailou"), first, second,
                                             {.replicates = 500})[Metric::kIou];
    significant += iou.p_value.value() < 0.05 ? 1 : 0;
    outside += iou.interval->low > 0.0 || iou.interval->high < 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(significant / static_cast<double>(kPairs), 0.06, 0.045);
  EXPECT_EQ(outside, significant) << "interval and p-value say the same";
}

/// Skewed replicates included: scans in which little moves, and few of them.
TEST(PairedDifference, IsSignificantExactlyWhereItsIntervalLeavesOutZero) {
  int significant = 0;
  int compared = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Normal normal(seed);
    const std::size_t scans = 12 + 4 * (seed % 10);
    std::vector<SequenceCounts> first = {wandering_scans(normal, scans, 0.7, 0.6)};
    std::vector<SequenceCounts> second = {wandering_scans(normal, scans, 0.7, 0.65)};
    for (SequenceCounts* run : {&first[0], &second[0]}) {
      for (std::size_t k = 0; k < scans; k += 3) (*run)[k] = counts((*run)[k].tp / 50, k, 2);
    }
    for (const double confidence : {0.5, 0.8, 0.9, 0.95, 0.99}) {
      const Differences differences =
          paired_difference(protocol_named("sipailou"), first, second,
                            {.replicates = 2000, .confidence = confidence});
      for (const Difference& metric : differences.metrics) {
        if (!metric.interval) continue;
        const bool outside = metric.interval->low > 0.0 || metric.interval->high < 0.0;
        EXPECT_EQ(outside, metric.p_value.value() < 1.0 - confidence)
            << "seed " << seed << ", confidence " << confidence;
        significant += outside ? 1 : 0;
        ++compared;
      }
    }
  }
  EXPECT_GT(significant, 50);
  EXPECT_GT(compared - significant, 50);
}

TEST(PairedDifference, HasNoIntervalForFewBlocks) {
  const std::vector<SequenceCounts> first = {{counts(5, 1, 4), counts(6, 0, 4), counts(7, 2, 3)}};
  const std::vector<SequenceCounts> second = {{counts(6, 1, 3), counts(6, 1, 4), counts(9, 0, 1)}};
  const Difference iou = paired_difference(protocol_named("sipailou"), first, second)[Metric::kIou];
  EXPECT_TRUE(iou.value);
  EXPECT_FALSE(iou.interval);
  EXPECT_FALSE(iou.p_value);
}

TEST(PairedDifference, RefusesOtherScans) {
  const std::vector<SequenceCounts> two = {{counts(1, 0, 0), counts(1, 0, 0)}};
  const std::vector<SequenceCounts> three = {{counts(1, 0, 0), counts(1, 0, 0), counts(1, 0, 0)}};
  EXPECT_THROW(paired_difference(protocol_named("sipailou"), two, three), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench
