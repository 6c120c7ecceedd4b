#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <set>

#include "eval/protocols/metrics.hpp"
#include "eval/protocols/score_counts.hpp"

namespace mosbench {
namespace {

const ScoreRule kRule{&protocol_named("semantickitti-mos"), {}};

/// Adds a scan of points with these scores; those of `truth` 1 move, 2 does not count. Labels are
/// moving from 2 on.
void add(ScoreCounts& counts, const std::vector<double>& scores, const std::vector<int>& truth) {
  std::vector<std::uint32_t> ids, labels;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    ids.push_back(truth[i] == 1 ? kMovingLabel : truth[i] == 0 ? kStaticLabel : 0U);
    labels.push_back(scores[i] >= 2 ? kMovingLabel : kStaticLabel);
  }
  counts.add({ids, scores, {}, score_scan(*kRule.protocol, ids, labels, {}, {})}, kRule);
}

// Worked by hand: five moving points, five static ones, a point that the protocol ignores.
TEST(ScoreCurve, IsThatOfTheScoresInOrder) {
  ScoreCounts counts;
  add(counts, {3, 3, 2, 1, 0, 7}, {1, 1, 0, 1, 0, 2});
  add(counts, {2, 1, -1, -0.0, 0}, {1, 0, 1, 0, 0});
  const ScoreCurve curve = counts.curve().value();
  ASSERT_EQ(curve.scans, 2U);
  std::vector<double> thresholds;
  std::vector<std::array<std::uint64_t, 4>> found;
  for (const CurvePoint& point : curve.points) {
    thresholds.push_back(point.threshold);
    found.push_back({point.counts.tp, point.counts.fp, point.counts.fn, point.counts.tn});
  }
  EXPECT_THAT(thresholds, testing::ElementsAre(3, 2, 1, 0, -1));
  EXPECT_EQ(found, (std::vector<std::array<std::uint64_t, 4>>{
                       {2, 0, 3, 5}, {3, 1, 2, 4}, {4, 2, 1, 3}, {4, 5, 1, 0}, {5, 5, 0, 0}}));
  EXPECT_NEAR(curve.average_precision,
              2.0 / 5 * 1 + 1.0 / 5 * 3 / 4 + 1.0 / 5 * 4 / 6 + 0 + 1.0 / 5 * 5 / 10, 1e-12);
  EXPECT_EQ(best_point(curve).threshold, 1) << "4 of 7";
  EXPECT_EQ(curve.of_labels, (Confusion{.tp = 3, .fp = 1, .fn = 2, .tn = 4, .ignored = 1}));
}

TEST(ScoreCurve, IsUndefinedWithoutMovingPoints) {
  ScoreCounts counts;
  add(counts, {3, 1}, {0, 0});
  EXPECT_FALSE(counts.curve());
}

/// Counts by a look at every point for every score.
std::vector<std::array<std::uint64_t, 4>> counted_again(const std::vector<double>& scores,
                                                        const std::vector<int>& truth) {
  const std::set<double, std::greater<>> thresholds(scores.begin(), scores.end());
  std::vector<std::array<std::uint64_t, 4>> found;
  for (const double threshold : thresholds) {
    auto& [tp, fp, fn, tn] = found.emplace_back();
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const bool moves = scores[i] >= threshold;
      ++(truth[i] == 1 ? (moves ? tp : fn) : (moves ? fp : tn));
    }
  }
  return found;
}

/// The sum of precision times the rise of recall, as scikit-learn defines it.
double average_precision_again(const std::vector<std::array<std::uint64_t, 4>>& counts) {
  double sum = 0.0, before = 0.0;
  for (const auto& [tp, fp, fn, tn] : counts) {
    const double recalled = static_cast<double>(tp) / static_cast<double>(tp + fn);
    sum += (recalled - before) * static_cast<double>(tp) / static_cast<double>(tp + fp);
    before = recalled;
  }
  return sum;
}

/// A score of few values, of 16 bits, of a float32 or of any double.
double score_of_kind(unsigned kind, std::mt19937& random) {
  const auto bits = static_cast<std::uint32_t>(random());
  if (kind == 0) return bits % 5;
  if (kind == 1) return bits % 65536;
  const double real = static_cast<double>(bits) / 4294967296.0;
  return kind == 2 ? static_cast<double>(static_cast<float>(real)) : real - 0.5;
}

TEST(ScoreCurve, IsThatOfBruteForceForScoresOfAnyKind) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    ScoreCounts counts, others;
    std::vector<double> scores;
    std::vector<int> truth;
    for (unsigned scan = 0; scan < 3; ++scan) {
      std::vector<double> of_scan;
      std::vector<int> moves = {1};
      for (std::size_t i = 0; i < 1 + random() % 60; ++i)
        moves.push_back(random() % 4 == 0 ? 1 : 0);
      for (std::size_t i = 0; i < moves.size(); ++i) {
        of_scan.push_back(score_of_kind(seed % 4, random));
      }
      add(scan == 0 ? others : counts, of_scan, moves);
      scores.insert(scores.end(), of_scan.begin(), of_scan.end());
      truth.insert(truth.end(), moves.begin(), moves.end());
    }
    counts += others;
    const ScoreCurve curve = counts.curve().value();
    const auto again = counted_again(scores, truth);
    ASSERT_EQ(curve.points.size(), again.size()) << seed;
    for (std::size_t i = 0; i < again.size(); ++i) {
      const Confusion& found = curve.points[i].counts;
      ASSERT_EQ((std::array{found.tp, found.fp, found.fn, found.tn}), again[i]) << seed;
    }
    EXPECT_NEAR(curve.average_precision, average_precision_again(again), 1e-12) << seed;
  }
}

TEST(ScoreCurve, JoinsScoresOfMoreScansThanItKeepsApart) {
  ScoreCounts counts;
  const std::size_t points = 400'000;
  std::vector<double> scores(points);
  for (std::size_t i = 0; i < points; ++i) scores[i] = static_cast<double>(i % 3);
  for (int scan = 0; scan < 4; ++scan) add(counts, scores, std::vector<int>(points, 1));
  const ScoreCurve curve = counts.curve().value();
  ASSERT_EQ(curve.points.size(), 3U);
  EXPECT_EQ(curve.points.back().counts, Confusion{.tp = 4 * points});
}

TEST(ScoreCurve, IsDrawnBySteps) {
  ScoreCounts counts;
  add(counts, {3, 2, 2, 1}, {1, 0, 1, 0});
  std::vector<std::array<double, 3>> places;
  for (const CurveCorner& corner : corners(counts.curve().value())) {
    places.push_back({corner.recall, corner.precision, corner.threshold});
  }
  EXPECT_EQ(places, (std::vector<std::array<double, 3>>{
                        {0, 1, 3}, {0.5, 1, 3}, {0.5, 2.0 / 3, 2}, {1, 2.0 / 3, 2}, {1, 0.5, 1}}));
}

TEST(ScoreCurve, IsThinnedToWhatCanBeSeen) {
  std::vector<double> scores;
  std::vector<int> truth;
  for (int i = 0; i < 4000; ++i) {
    const auto number = static_cast<double>(i % 2000);
    scores.push_back(i < 2000 ? number + 1.0 : -1.0 - 0.0015 * number);
    truth.push_back(i % 2);
  }
  ScoreCounts counts;
  add(counts, scores, truth);
  const ScoreCurve curve = counts.curve().value();
  EXPECT_EQ(curve.points.size(), 4000U);
  EXPECT_TRUE(std::ranges::is_sorted(curve.points, std::greater(), &CurvePoint::threshold));
  const std::vector<CurvePoint> kept = thinned(curve);
  EXPECT_LT(kept.size(), curve.points.size());
  EXPECT_GT(kept.size(), 900U);
  EXPECT_EQ(kept.back().threshold, curve.points.back().threshold);
}

}  // namespace
}  // namespace mosbench
