#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "eval/protocols/metrics.hpp"
#include "tests/random_scans.hpp"

namespace mosbench {
namespace {

constexpr int kScoredScans = 40;
constexpr std::size_t kPoints = 500;

class ScoreProperty : public testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < kScoredScans; ++k) scans_.push_back(random_scan(random_, kPoints, kAllIds));
  }
  static Confusion score(const Protocol& protocol, const RandomScan& scan) {
    return score_scan(protocol, scan.truth, scan.prediction, scan.points);
  }

  std::mt19937 random_{20240831};
  std::vector<RandomScan> scans_;
};

TEST_F(ScoreProperty, EveryPointIsCountedOnce) {
  for (const Protocol& protocol : protocols()) {
    Confusion pooled;
    for (const RandomScan& scan : scans_) {
      const Confusion counts = score(protocol, scan);
      EXPECT_EQ(counts.points(), kPoints) << protocol.name;
      pooled += counts;
    }
    EXPECT_GT(pooled.tp, 0U) << protocol.name;
    EXPECT_GT(pooled.fp, 0U) << protocol.name;
    EXPECT_GT(pooled.fn, 0U) << protocol.name;
    EXPECT_GT(pooled.tn, 0U) << protocol.name;
  }
}

TEST_F(ScoreProperty, TheOrderOfPointsDoesNotMatter) {
  std::vector<std::size_t> order(kPoints);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (const RandomScan& scan : scans_) {
    std::ranges::shuffle(order, random_);
    RandomScan shuffled;
    for (const std::size_t i : order) {
      shuffled.truth.push_back(scan.truth[i]);
      shuffled.prediction.push_back(scan.prediction[i]);
      shuffled.points.push_back(scan.points[i]);
    }
    for (const Protocol& protocol : protocols()) {
      EXPECT_EQ(score(protocol, shuffled), score(protocol, scan)) << protocol.name;
    }
  }
}

TEST_F(ScoreProperty, CountsOfAScanAreTheSumOverItsParts) {
  for (const RandomScan& scan : scans_) {
    const std::size_t cut = random_() % kPoints;
    for (const Protocol& protocol : protocols()) {
      const auto part = [&](std::size_t first, std::size_t count) {
        return score_scan(protocol, std::span(scan.truth).subspan(first, count),
                          std::span(scan.prediction).subspan(first, count),
                          std::span(scan.points).subspan(first, count));
      };
      Confusion sum = part(0, cut);
      sum += part(cut, kPoints - cut);
      EXPECT_EQ(sum, score(protocol, scan)) << protocol.name;
    }
  }
}

TEST_F(ScoreProperty, PooledCountsAreTheSumOverTheScans) {
  for (const Protocol& protocol : protocols()) {
    std::vector<Confusion> counts;
    Confusion sum;
    for (const RandomScan& scan : scans_) {
      counts.push_back(score(protocol, scan));
      sum += counts.back();
    }
    const Summary summary = summarize(protocol, counts);
    EXPECT_EQ(summary.pooled, sum) << protocol.name;
    if (protocol.aggregation != Aggregation::kMeanOfScans) {
      EXPECT_EQ(summary[Metric::kIou], moving_iou(sum)) << protocol.name;
    }
  }
}

TEST_F(ScoreProperty, SwappingTruthAndPredictionSwapsFalsePositivesAndNegatives) {
  // Only where nothing is ignored, no range cuts one side alone and both sides share one map.
  std::size_t symmetric = 0;
  for (const Protocol& protocol : protocols()) {
    if (protocol.name != "sipailou" && protocol.name != "moe" && protocol.name != "mapmos-apollo" &&
        protocol.name != "doals-dynablox") {
      continue;
    }
    ++symmetric;
    for (const RandomScan& scan : scans_) {
      Confusion swapped = score_scan(protocol, scan.prediction, scan.truth, scan.points);
      std::swap(swapped.fp, swapped.fn);
      EXPECT_EQ(swapped, score(protocol, scan)) << protocol.name;
    }
  }
  EXPECT_EQ(symmetric, 4U);
}

TEST_F(ScoreProperty, MetricsLieBetweenZeroAndOneAndIouIsTheSmallest) {
  for (const Protocol& protocol : protocols()) {
    for (const RandomScan& scan : scans_) {
      const Confusion counts = score(protocol, scan);
      ASSERT_TRUE(moving_iou(counts) && precision(counts) && recall(counts) &&
                  metric_of(counts, Metric::kF1));
      EXPECT_GE(*moving_iou(counts), 0.0);
      EXPECT_LE(*moving_iou(counts), *precision(counts));
      EXPECT_LE(*moving_iou(counts), *recall(counts));
      EXPECT_LE(*moving_iou(counts), *metric_of(counts, Metric::kF1));
      EXPECT_LE(*metric_of(counts, Metric::kF1), 1.0);
    }
  }
}

TEST_F(ScoreProperty, ATruthScoredAgainstItselfIsPerfect) {
  for (const Protocol& protocol : protocols()) {
    if (protocol.range_rule == RangeRule::kTruthOnly) continue;
    for (const RandomScan& scan : scans_) {
      const Confusion counts = score_scan(protocol, scan.truth, scan.truth, scan.points);
      EXPECT_EQ(moving_iou(counts), 1.0) << protocol.name;
    }
  }
}

}  // namespace
}  // namespace mosbench
