#include "eval/statistics/intervals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "eval/protocols/metrics.hpp"
#include "eval/statistics/uncertainty.hpp"
#include "tests/unit/eval/confusions.hpp"

namespace mosbench {
namespace {

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

/// Autoregressive values of variance 1.
std::vector<double> autoregressive(unsigned seed, std::size_t scans, double memory) {
  Normal normal(seed);
  std::vector<double> series = {normal()};
  while (series.size() < scans) {
    series.push_back(memory * series.back() + std::sqrt(1.0 - memory * memory) * normal());
  }
  return series;
}

// The numbers are of printed tables and of mpmath with 30 digits.
TEST(Distributions, EqualTheTables) {
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

/// Scans of equal weight with these errors, and as many moving points as they err.
std::vector<ScanErrors> scans_with(const std::vector<std::vector<double>>& errors) {
  std::vector<ScanErrors> sequences;
  for (const std::vector<double>& own : errors) {
    sequences.push_back({own, std::vector<double>(own.size(), 1.0), own});
  }
  return sequences;
}

SumUncertainty uncertainty_of(const std::vector<std::vector<double>>& errors,
                              Spacing spacing = Spacing::kNear) {
  return uncertainty_of_sum(scans_with(errors), spacing);
}

/// Mean over many series of the estimated variance of the sum.
double mean_variance(std::size_t scans, double memory) {
  constexpr unsigned kSeries = 200;
  double mean = 0.0;
  for (unsigned seed = 1; seed <= kSeries; ++seed) {
    const SumUncertainty found = uncertainty_of({autoregressive(seed, scans, memory)});
    EXPECT_EQ(found.unknown, "");
    mean += found.standard_error * found.standard_error / kSeries;
  }
  return mean;
}

TEST(NeighbourCorrelation, IsThatOfTheProcess) {
  const std::vector<std::vector<double>> series = {autoregressive(1, 4000, 0.7)};
  EXPECT_NEAR(neighbour_correlation(series).value, 0.7, 0.04);
  EXPECT_NEAR(neighbour_correlation(series).error, 0.0113, 0.001);
}

TEST(NeighbourCorrelation, OfEqualValuesIsNothing) {
  for (const double value : {0.0, 1000.0, 0.1}) {
    const std::vector<std::vector<double>> series = {std::vector<double>(150, value)};
    EXPECT_EQ(neighbour_correlation(series).value, 0.0) << value;
    EXPECT_NEAR(neighbour_correlation(series).error, 0.0816, 0.001) << value;
  }
}

// The variance of the sum of n such values is n (1 + r) / (1 - r); 200 estimates with nine degrees
// of freedom have a mean with a deviation of 3 %. The correlation is taken larger than measured.
TEST(UncertaintyOfSum, HasTheVarianceOfCorrelatedValues) {
  EXPECT_NEAR(mean_variance(1000, 0.0) / 1000.0, 1.0, 0.1);
  EXPECT_NEAR(mean_variance(1000, 0.8) / 9000.0, 1.0, 0.15);
}

TEST(UncertaintyOfSum, OfEqualValuesIsNothing) {
  EXPECT_NEAR(uncertainty_of({std::vector<double>(200, 3.0)}).standard_error, 0.0, 1e-9);
}

TEST(UncertaintyOfSum, OfScansFarApartIsThatOfIndependentOnes) {
  const std::vector<double> errors = {3, 1, -2, 0, 4, -3, 1, 2, -5, -1,
                                      3, 1, -2, 0, 4, -3, 1, 2, -5, -1};
  const SumUncertainty found = uncertainty_of({errors}, Spacing::kFar);
  ASSERT_EQ(found.unknown, "");
  EXPECT_NEAR(found.standard_error, std::sqrt(20.0 / 19.0 * 140.0), 1e-12);
  EXPECT_NEAR(found.freedom, 19.0, 1e-12);
}

TEST(UncertaintyOfSum, HasFewerDegreesOfFreedomWhereScansCountUnequally) {
  std::vector<ScanErrors> scans = scans_with({autoregressive(4, 20, 0.0)});
  for (std::size_t k = 0; k < 20; k += 2) scans[0].weight[k] = 0.0;
  const SumUncertainty found = uncertainty_of_sum(scans, Spacing::kFar);
  ASSERT_EQ(found.unknown, "");
  EXPECT_NEAR(found.freedom, 9.0, 1e-12);
}

TEST(UncertaintyOfSum, SaysWhyItIsUnknown) {
  EXPECT_EQ(uncertainty_of({autoregressive(1, 99, 0.7)}).unknown,
            "99 scans, expected at least 100 in a row, or 20 that are 10 s apart");
  EXPECT_EQ(uncertainty_of({autoregressive(1, 19, 0.0)}, Spacing::kFar).unknown,
            "19 scans, expected at least 100 in a row, or 20 that are 10 s apart");
  EXPECT_EQ(uncertainty_of({autoregressive(1, 40, 0.9)}, Spacing::kFar).unknown,
            "40 scans that are alike, though far apart, expected at least 100");
  EXPECT_THAT(uncertainty_of({autoregressive(1, 200, 0.99)}).unknown,
              testing::StartsWith("neighbouring scans are too alike for 200 per sequence"));
  EXPECT_EQ(uncertainty_of({autoregressive(1, 200, 0.0), autoregressive(2, 3, 0.0)}).unknown,
            "a sequence of 3 scans, expected at least 4");
  EXPECT_NE(uncertainty_of({}).unknown, "");
  std::vector<ScanErrors> empty_but_two = scans_with({autoregressive(1, 200, 0.0)});
  empty_but_two[0].weight.assign(200, 0.0);
  empty_but_two[0].weight[17] = empty_but_two[0].weight[90] = 1.0;
  EXPECT_EQ(uncertainty_of_sum(empty_but_two, Spacing::kNear).unknown,
            "2 of 200 scans hold nearly all points that count, expected at least 6");
}

/// Share of many series of scans in a row for which an uncertainty is stated.
double stated(std::size_t scans, double memory) {
  constexpr unsigned kSeries = 300;
  unsigned stated = 0;
  for (unsigned seed = 1; seed <= kSeries; ++seed) {
    if (uncertainty_of({autoregressive(seed, scans, memory)}).unknown.empty()) ++stated;
  }
  return stated / static_cast<double>(kSeries);
}

TEST(UncertaintyOfSum, OfFewScansInARowIsStatedOnlyWhereTheyAreSurelyNotAlike) {
  EXPECT_GT(stated(20, 0.0), 0.1);
  EXPECT_GT(stated(60, 0.0), 0.3);
  for (const double memory : {0.5, 0.8, 0.95}) {
    EXPECT_LT(stated(20, memory), 0.03) << memory;
    EXPECT_LT(stated(60, memory), 0.03) << memory;
  }
}

TEST(Estimate, GivesTheValuesOfTheTable) {
  std::mt19937 random(5);
  for (const Protocol& protocol : protocols()) {
    std::vector<SequenceCounts> sequences(3);
    std::vector<Summary> summaries;
    SequenceCounts all;
    for (SequenceCounts& sequence : sequences) {
      for (int k = 0; k < 40; ++k) {
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
    EXPECT_NEAR(estimates[Metric::kIou].value.value(), summary[Metric::kIou].value(), 1e-12)
        << protocol.name;
    EXPECT_NEAR(estimates[Metric::kPrecision].value.value(), summary[Metric::kPrecision].value(),
                1e-12);
    EXPECT_NEAR(estimates[Metric::kRecall].value.value(), summary[Metric::kRecall].value(), 1e-12);
    EXPECT_NEAR(estimates[Metric::kF1].value.value(), summary[Metric::kF1].value(), 1e-12);
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
double coverage(const char* protocol, std::size_t scans, double memory,
                Spacing spacing = Spacing::kNear) {
  constexpr int kRuns = 300;
  int covered = 0;
  int given = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    Normal normal(seed);
    const std::vector<SequenceCounts> run = {wandering_scans(normal, scans, memory, 0.6)};
    const Estimate iou = estimate(protocol_named(protocol), run, spacing)[Metric::kIou];
    if (!iou.interval) continue;
    ++given;
    if (iou.interval->low <= 0.6 && 0.6 <= iou.interval->high) ++covered;
  }
  EXPECT_GT(given, kRuns * 3 / 4);
  return covered / static_cast<double>(given);
}

// 300 runs give a share of 95 % with a standard deviation of 1.3 %. bench/interval_coverage.cpp
// measures it more exactly.
TEST(Estimate, CoversTheTruthAsOftenAsItSays) {
  for (const char* protocol : {"sipailou", "doals-hmm"}) {
    EXPECT_NEAR(coverage(protocol, 100, 0.0), 0.95, 0.035) << "independent scans";
    EXPECT_NEAR(coverage(protocol, 400, 0.7), 0.95, 0.035) << "neighbours alike";
    EXPECT_NEAR(coverage(protocol, 2000, 0.95), 0.95, 0.035) << "a long memory";
    EXPECT_NEAR(coverage(protocol, 20, 0.0, Spacing::kFar), 0.95, 0.035) << "scans of DOALS";
  }
}

TEST(PairedDifference, OfARunWithItselfIsNothing) {
  Normal normal(1);
  const std::vector<SequenceCounts> run = {wandering_scans(normal, 150, 0.5, 0.6)};
  const Difference iou = paired_difference(protocol_named("sipailou"), run, run)[Metric::kIou];
  EXPECT_EQ(iou.value, 0.0);
  EXPECT_EQ(iou.interval, (Interval{0.0, 0.0}));
  EXPECT_EQ(iou.p_value, 1.0);
  EXPECT_EQ(iou.smallest_detectable, 0.0);
}

TEST(PairedDifference, FindsASmallChangeThatTheRunsIntervalsHide) {
  Normal normal(1);
  const std::vector<SequenceCounts> before = {wandering_scans(normal, 150, 0.5, 0.6)};
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
  EXPECT_LT(iou.p_value.value(), 0.01);
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
    const std::vector<SequenceCounts> first = {wandering_scans(normal, 150, 0.5, 0.6)};
    const std::vector<SequenceCounts> second = {wandering_scans(normal, 150, 0.5, 0.6)};
    const Difference iou =
        paired_difference(protocol_named("sipailou"), first, second)[Metric::kIou];
    significant += iou.p_value.value() < 0.05 ? 1 : 0;
    outside += iou.interval->low > 0.0 || iou.interval->high < 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(significant / static_cast<double>(kPairs), 0.05, 0.035);
  EXPECT_EQ(outside, significant) << "interval and p-value say the same";
}

TEST(PairedDifference, HasNoIntervalForFewScans) {
  const std::vector<SequenceCounts> first = {{counts(5, 1, 4), counts(6, 0, 4), counts(7, 2, 3)}};
  const std::vector<SequenceCounts> second = {{counts(6, 1, 3), counts(6, 1, 4), counts(9, 0, 1)}};
  const Difference iou = paired_difference(protocol_named("sipailou"), first, second)[Metric::kIou];
  EXPECT_TRUE(iou.value);
  EXPECT_FALSE(iou.interval);
  EXPECT_FALSE(iou.p_value);
  EXPECT_EQ(iou.no_interval, "3 scans, expected at least 100 in a row, or 20 that are 10 s apart");
}

TEST(PairedDifference, RefusesOtherScans) {
  const std::vector<SequenceCounts> two = {{counts(1, 0, 0), counts(1, 0, 0)}};
  const std::vector<SequenceCounts> three = {{counts(1, 0, 0), counts(1, 0, 0), counts(1, 0, 0)}};
  EXPECT_THROW(paired_difference(protocol_named("sipailou"), two, three), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench
