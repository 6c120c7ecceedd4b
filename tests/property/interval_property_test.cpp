#include <gtest/gtest.h>

#include <random>

#include "eval/statistics/intervals.hpp"

namespace mosbench {
namespace {

/// Two runs on the same scans of one to three sequences: skewed counts, also scans in which nothing
/// moves, and now and then a second run that is clearly better.
struct TwoRuns {
  std::vector<SequenceCounts> first, second;
};

TwoRuns two_runs(std::mt19937& random) {
  TwoRuns runs;
  const std::size_t sequences = 1 + random() % 3;
  const std::uint64_t better = random() % 3 == 0 ? 1 + random() % 30 : 0;
  for (std::size_t s = 0; s < sequences; ++s) {
    const std::size_t scans = 4 + random() % 90;
    runs.first.emplace_back();
    runs.second.emplace_back();
    for (std::size_t k = 0; k < scans; ++k) {
      const std::uint64_t moving = random() % 4 == 0 ? 0 : 50 + random() % (random() % 9 * 100 + 1);
      Confusion counts;
      counts.tp = moving * (60 + random() % 20) / 100;
      counts.fn = moving - counts.tp;
      counts.fp = random() % 40;
      runs.first.back().push_back(counts);
      counts.tp = moving * std::min<std::uint64_t>(100, 60 + better + random() % 20) / 100;
      counts.fn = moving - counts.tp;
      counts.fp = random() % 40;
      runs.second.back().push_back(counts);
    }
  }
  return runs;
}

TEST(PairedDifference, IsSignificantExactlyWhereItsIntervalLeavesOutZero) {
  std::mt19937 random(1);
  int significant = 0, compared = 0, refused = 0;
  for (int draw = 0; draw < 300; ++draw) {
    const TwoRuns runs = two_runs(random);
    const Protocol& protocol = protocols()[random() % protocols().size()];
    const Spacing spacing = random() % 2 == 0 ? Spacing::kNear : Spacing::kFar;
    for (const double confidence : {0.5, 0.8, 0.9, 0.95, 0.99}) {
      const Differences differences =
          paired_difference(protocol, runs.first, runs.second, spacing, confidence);
      for (const Difference& metric : differences.metrics) {
        if (!metric.value) continue;
        ASSERT_EQ(metric.interval.has_value(), metric.no_interval.empty());
        ASSERT_EQ(metric.interval.has_value(), metric.p_value.has_value());
        refused += metric.interval ? 0 : 1;
        if (!metric.interval) continue;
        const bool outside = metric.interval->low > 0.0 || metric.interval->high < 0.0;
        EXPECT_EQ(outside, *metric.p_value < 1.0 - confidence)
            << "draw " << draw << ", confidence " << confidence;
        significant += outside ? 1 : 0;
        ++compared;
      }
    }
  }
  EXPECT_GT(significant, 500);
  EXPECT_GT(compared - significant, 500);
  EXPECT_GT(refused, 100);
}

TEST(Estimate, LiesInItsInterval) {
  std::mt19937 random(2);
  int given = 0;
  for (int draw = 0; draw < 300; ++draw) {
    const TwoRuns runs = two_runs(random);
    const Protocol& protocol = protocols()[random() % protocols().size()];
    for (const Estimate& metric : estimate(protocol, runs.first, Spacing::kFar).metrics) {
      if (!metric.interval) continue;
      ++given;
      EXPECT_LE(0.0, metric.interval->low);
      EXPECT_LT(metric.interval->low, *metric.value);
      EXPECT_LT(*metric.value, metric.interval->high);
      EXPECT_LE(metric.interval->high, 1.0);
    }
  }
  EXPECT_GT(given, 500);
}

}  // namespace
}  // namespace mosbench
