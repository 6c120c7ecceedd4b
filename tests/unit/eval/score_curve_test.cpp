#include "eval/report/score_curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "eval/protocols/metrics.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

const ScoreRule kRule{&protocol_named("semantickitti-mos"), {}};

/// A scan of points with these scores; those of `truth` 1 move. Labels are moving from 2 on.
JudgedScan scan_of(const std::vector<float>& scores, const std::vector<int>& truth) {
  JudgedScan scan;
  scan.scores = scores;
  scan.frame.points.resize(scores.size());
  std::vector<std::uint32_t> ids, labels;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    ids.push_back(truth[i] == 1 ? kMovingLabel : truth[i] == 0 ? kStaticLabel : 0U);
    labels.push_back(scores[i] >= 2 ? kMovingLabel : kStaticLabel);
  }
  scan.outcomes = point_outcomes(*kRule.protocol, ids, labels, {}, {});
  scan.frame.truth = ids;
  return scan;
}

// Worked by hand: five moving points, five static ones, a point that the protocol ignores.
TEST(ScoreCurve, IsThatOfTheScoresInOrder) {
  ScoreCounts counts;
  counts.add(scan_of({3, 3, 2, 1, 0, 7}, {1, 1, 0, 1, 0, 2}), kRule);
  counts.add(scan_of({2, 1, -1, -0.0F, 0}, {1, 0, 1, 0, 0}), kRule);
  const ScoreCurve curve = counts.curve();
  ASSERT_EQ(curve.scans, 2U);
  std::vector<float> thresholds;
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
  counts.add(scan_of({3, 1}, {0, 0}), kRule);
  EXPECT_EQ(message_of<std::domain_error>([&] { counts.curve(); }), "no point moves in the truth");
}

TEST(ScoreCurve, KeepsScoresApartThatDifferByAThousandth) {
  std::vector<float> scores;
  std::vector<int> truth;
  for (int i = 0; i < 4000; ++i) {
    const auto number = static_cast<float>(i % 2000);
    scores.push_back(i < 2000 ? number + 1.0F : -1.0F - 0.0015F * number);
    truth.push_back(i % 2);
  }
  ScoreCounts counts;
  counts.add(scan_of(scores, truth), kRule);
  const ScoreCurve curve = counts.curve();
  EXPECT_EQ(curve.points.size(), 4000U);
  EXPECT_TRUE(std::ranges::is_sorted(curve.points, std::greater(), &CurvePoint::threshold));
  const std::vector<CurvePoint> kept = thinned(curve);
  EXPECT_LT(kept.size(), curve.points.size());
  EXPECT_GT(kept.size(), 900U);
  EXPECT_EQ(kept.back().threshold, curve.points.back().threshold);
}

}  // namespace
}  // namespace mosbench
