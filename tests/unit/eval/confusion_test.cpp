#include "eval/protocols/confusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "tests/unit/eval/confusions.hpp"

namespace mosbench {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Confusion score_one(std::string_view protocol, std::uint32_t truth, std::uint32_t prediction,
                    const Point& point) {
  return score_scan(protocol_named(protocol), Labels{truth}, Labels{prediction},
                    std::vector<Point>{point});
}

constexpr Confusion kTruePositive{.tp = 1};
constexpr Confusion kFalsePositive{.fp = 1};
constexpr Confusion kFalseNegative{.fn = 1};
constexpr Confusion kTrueNegative{.tn = 1};
constexpr Confusion kIgnoredPoint{.ignored = 1};

TEST(ScoreScan, CountsAnUnlabelledPredictionOnAMovingPointAsMissed) {
  EXPECT_EQ(score("semantickitti-mos", {251}, {0}), kFalseNegative);
  EXPECT_EQ(score("sipailou", {251}, {0}), kFalseNegative);
}

TEST(ScoreScan, DoesNotCountAMovingPredictionOnUnlabelledTruthOfSemanticKitti) {
  EXPECT_EQ(score("semantickitti-mos", {0}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("semantickitti-mos", {1}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("helimos-all", {0}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("helimos-test", {0}, {251}), kIgnoredPoint);
}

TEST(ScoreScan, TakesUnlabelledTruthAsStaticWhereTheBenchmarkDoes) {
  for (const std::string_view name : {"sipailou", "mapmos-apollo", "doals-hmm", "moe"}) {
    EXPECT_EQ(score(name, {0}, {251}), kFalsePositive) << name;
  }
}

TEST(ScoreScan, ReadsTheLower16BitsOfTruthAndPrediction) {
  for (const Protocol& protocol : protocols()) {
    if (protocol.name == "mdetector-nuscenes") continue;
    EXPECT_EQ(score(protocol.name, {0x000500FB}, {251}), kTruePositive) << protocol.name;
    EXPECT_EQ(score(protocol.name, {251}, {0xFFFF00FB}), kTruePositive) << protocol.name;
    EXPECT_EQ(score(protocol.name, {0x00050009}, {0x00070009}), kTrueNegative) << protocol.name;
  }
}

TEST(ScoreScan, IgnoresUnknownSemanticKittiTruthAndCountsItsId) {
  const Confusion counts = score("semantickitti-mos", {2, 12, 260, 5000}, {251, 9, 251, 251});
  EXPECT_EQ(counts, (Confusion{.ignored = 4, .unknown_ids = 4}));
}

TEST(ScoreScan, TakesAnUnknownSemanticKittiPredictionAsNotMoving) {
  const Confusion counts = score("semantickitti-mos", {251, 9}, {260, 5000});
  EXPECT_EQ(counts, (Confusion{.fn = 1, .tn = 1, .unknown_ids = 2}));
}

TEST(ScoreScan, TakesAllIdsFrom251To259AsMovingUnderSemanticKitti) {
  for (std::uint32_t id = 251; id <= 259; ++id) {
    EXPECT_EQ(score("semantickitti-mos", {id}, {id}), kTruePositive) << id;
  }
  EXPECT_EQ(score("semantickitti-mos", {260}, {251}).ignored, 1U);
}

TEST(ScoreScan, TakesUnknownSipailouIdsAsStatic) {
  const Confusion counts = score("sipailou", {1, 253}, {251, 253});
  EXPECT_EQ(counts, (Confusion{.fp = 1, .tn = 1, .unknown_ids = 2}));
}

TEST(ScoreScan, CountsAPointWithTwoUnknownIdsOnce) {
  EXPECT_EQ(score("sipailou", {7}, {8}).unknown_ids, 1U);
}

TEST(ScoreScan, FollowsMapmosThresholdsBetween1And251) {
  EXPECT_EQ(score("mapmos", {1}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("mapmos", {2}, {251}), kFalsePositive);
  EXPECT_EQ(score("mapmos", {250}, {250}), kTrueNegative);
  EXPECT_EQ(score("mapmos", {251}, {300}), kTruePositive);
  EXPECT_EQ(score("mapmos-kitti-tracking", {2}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("mapmos-kitti-tracking", {3}, {251}), kFalsePositive);
}

TEST(ScoreScan, FollowsMdetectorThresholds) {
  EXPECT_EQ(score("mdetector", {65535}, {251}), kIgnoredPoint);
  EXPECT_EQ(score("mdetector", {251}, {65535}), kFalseNegative);
  EXPECT_EQ(score("mdetector", {300}, {251}), kTruePositive);
  EXPECT_EQ(score("mdetector-nuscenes", {999, 65535}, {251, 0}),
            (Confusion{.tn = 1, .ignored = 1}));
  EXPECT_EQ(score("mdetector-nuscenes", {1000, 65535}, {251, 0}),
            (Confusion{.tp = 1, .ignored = 1}));
}

TEST(ScoreScan, CountsAPredictionOutOfRangeAgainstTheMethodOnlyUnderDoalsHmm) {
  const Point far{30.0F, 0.0F, 0.0F, 0.0F};
  EXPECT_EQ(score_one("doals-hmm", 251, 251, far), kFalsePositive);
  EXPECT_EQ(score_one("doals-hmm", 251, 9, far), kTrueNegative);
  EXPECT_EQ(score_one("doals-dynablox", 251, 251, far), kIgnoredPoint);
  EXPECT_EQ(score_one("mapmos", 251, 251, far), kTruePositive);
}

TEST(ScoreScan, LeavesOutWhatIsNearUnderMapmosNuscenes) {
  const Point near{2.999F, 0.0F, 0.0F, 0.0F}, at{0.0F, 3.0F, 0.0F, 0.0F};
  EXPECT_EQ(score_one("mapmos-nuscenes", 251, 251, near), kIgnoredPoint);
  EXPECT_EQ(score_one("mapmos-nuscenes", 9, 251, near), kIgnoredPoint);
  EXPECT_EQ(score_one("mapmos-nuscenes", 251, 251, at), kTruePositive);
  EXPECT_EQ(score_one("mapmos-nuscenes", 251, 9, Point{200.0F, 0.0F, 0.0F, 0.0F}), kFalseNegative);
}

TEST(ScoreScan, IncludesPointsExactlyAtTheLimits) {
  for (const Point& point : {Point{0.5F, 0.0F, 0.0F, 0.0F}, Point{0.0F, -20.0F, 0.0F, 0.0F}}) {
    EXPECT_EQ(score_one("doals-hmm", 251, 251, point), kTruePositive);
    EXPECT_EQ(score_one("doals-dynablox", 251, 251, point), kTruePositive);
  }
}

TEST(ScoreScan, TakesPointsWithoutAFiniteRangeAsOutOfRange) {
  for (const float bad : {kNoNumber, kInfinity}) {
    const Point point{bad, 0.0F, 0.0F, 0.0F};
    EXPECT_EQ(score_one("doals-hmm", 251, 251, point), kFalsePositive);
    EXPECT_EQ(score_one("doals-dynablox", 251, 251, point), kIgnoredPoint);
  }
  EXPECT_EQ(score_one("mapmos", 251, 251, Point{kNoNumber, 0.0F, 0.0F, 0.0F}), kIgnoredPoint);
  EXPECT_EQ(score_one("mapmos", 251, 251, Point{kInfinity, 0.0F, 0.0F, 0.0F}), kTruePositive);
}

TEST(ScoreScan, RoundsTheRangeAsTheProgramDoes) {
  // A point whose range is just above 20 m in double and exactly 20 m in float.
  const Point point{12.000001F, 16.0F, 0.0F, 0.0F};
  ASSERT_GT(range_m(point, Arithmetic::kDouble), 20.0);
  ASSERT_EQ(range_m(point, Arithmetic::kFloat), 20.0);
  EXPECT_EQ(score_one("doals-hmm", 251, 251, point), kFalsePositive);
  EXPECT_EQ(score_one("doals-dynablox", 251, 251, point), kTruePositive);
}

TEST(ScoreScan, TakesLimitsOtherThanTheDefaults) {
  const std::vector<Point> points = {{30.0F, 0.0F, 0.0F, 0.0F}};
  const Confusion counts = score_scan(protocol_named("doals-hmm"), Labels{251}, Labels{251}, points,
                                      RangeGate{0.5, 120.0});
  EXPECT_EQ(counts, kTruePositive);
}

TEST(ScoreScan, NeedsNoPointsWithoutARangeRule) {
  EXPECT_EQ(score_scan(protocol_named("sipailou"), Labels{251}, Labels{251}, {}), kTruePositive);
}

TEST(ScoreScan, CountsAnEmptyScanAsNothing) {
  EXPECT_EQ(score("doals-hmm", {}, {}), Confusion{});
  EXPECT_EQ(score("sipailou", {}, {}), Confusion{});
}

TEST(ScoreScan, RefusesSizesThatDiffer) {
  const std::vector<Point> two(2);
  EXPECT_THROW(score_scan(protocol_named("sipailou"), Labels{9, 9}, Labels{9}, {}),
               std::invalid_argument);
  EXPECT_THROW(score_scan(protocol_named("sipailou"), Labels{9}, Labels{9}, two),
               std::invalid_argument);
  EXPECT_THROW(score_scan(protocol_named("doals-hmm"), Labels{9}, Labels{9}, {}),
               std::invalid_argument);
}

TEST(ScoreScan, RefusesLimitsThatAreNoInterval) {
  const std::vector<Point> one(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const RangeGate& limits :
       {RangeGate{20.0, 0.5}, RangeGate{nan, 20.0}, RangeGate{0.5, nan}}) {
    EXPECT_THROW(score_scan(protocol_named("doals-hmm"), Labels{9}, Labels{9}, one, limits),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace mosbench
