#include "eval/protocols/unsure.hpp"

#include <gtest/gtest.h>

#include <random>

#include "eval/protocols/metrics.hpp"
#include "tests/unit/eval/confusions.hpp"

namespace mosbench {
namespace {

TEST(UnsureBounds, AreTheLeastAndMostIouOfAllTheUnsurePointsMayBe) {
  std::mt19937 random(11);
  const ScoreRule rule{&protocol_named("mapmos"), kNoLimits};
  for (int round = 0; round < 30; ++round) {
    Labels truth = {kMovingLabel, kStaticLabel, kMovingLabel}, prediction;
    for (int i = 0; i < 6; ++i) truth.push_back(i % 2 == 0 ? 0 : 0x30000);  // of an instance, too
    for (std::size_t i = 0; i < truth.size(); ++i) {
      prediction.push_back(random() % 2 == 0 ? kMovingLabel : kStaticLabel);
    }
    const std::vector<Point> points(truth.size(), Point{5.0F, 0.0F, 0.0F, 0.0F});
    double least = 1, most = 0;
    for (unsigned guess = 0; guess < 64; ++guess) {
      Labels one = truth;
      for (std::size_t i = 0; i < 6; ++i) {
        one[3 + i] = (guess >> i & 1U) != 0 ? kMovingLabel : kStaticLabel;
      }
      const double iou =
          moving_iou(score_scan(*rule.protocol, one, prediction, points, rule.range)).value();
      least = std::min(least, iou);
      most = std::max(most, iou);
    }
    UnsureBounds bounds;
    bounds.add(rule, truth, prediction, points);
    ASSERT_EQ(moving_iou(bounds.lowest), least);
    ASSERT_EQ(moving_iou(bounds.highest), most);
  }
}

TEST(UnsureBounds, SayNothingWithoutUnsurePoints) {
  const ScoreRule rule{&protocol_named("mapmos"), kNoLimits};
  const std::vector<Point> points(2, Point{5.0F, 0.0F, 0.0F, 0.0F});
  UnsureBounds bounds;
  bounds.add(rule, Labels{251, 9}, Labels{251, 251}, points);
  EXPECT_EQ(bounds.text(rule), "");
  UnsureBounds other;
  other.add(rule, Labels{251, 0}, Labels{251, 251}, points);
  bounds += other;
  EXPECT_TRUE(
      bounds.text(rule).starts_with("unsure points leave 50.0 to 75.0 % IoU open, by mapmos"));
}

}  // namespace
}  // namespace mosbench
