#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "datasets/layouts/boxes.hpp"

namespace mosbench {
namespace {

/// Points of walls that cross each other, and of a cloud around.
std::vector<Point> random_points(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<float> far(-30.0F, 30.0F), near(-0.1F, 0.1F);
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    switch (i % 3) {
      case 0:
        points.push_back({far(random), near(random), far(random), 0});
        break;
      case 1:
        points.push_back({near(random), far(random), far(random), 0});
        break;
      default:
        points.push_back({far(random), far(random), far(random), 0});
    }
  }
  return points;
}

TEST(PureBoxes, HoldThePointsThatTheyShouldAndNoOther) {
  std::mt19937 random(7);
  for (std::size_t round = 0; round < 20; ++round) {
    const auto points = random_points(random, 400);
    std::vector<std::uint32_t> inside, outside, expected(points.size(), 9);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const bool is_inside = round == 0 || (i % 3 == 0 && points[i].x > 5.0F) || random() % 50 == 0;
      (is_inside ? inside : outside).push_back(i);
      if (is_inside) expected[i] = 251;
    }
    const auto boxes = pure_boxes(points, inside, outside);
    EXPECT_LE(boxes.size(), inside.size());
    if (round == 0) {
      EXPECT_EQ(boxes.size(), 1U);
    }
    std::vector<std::uint32_t> labels(points.size(), 9);
    const PointsInBoxes search(points);
    for (const AxisBox& box : boxes) {
      Pose box_from_points = Pose::Identity();
      box_from_points.translation() = -0.5 * (box.low_m + box.high_m);
      search.label(box_from_points, 0.5 * (box.high_m - box.low_m), 251, labels);
    }
    EXPECT_EQ(labels, expected) << "round " << round;
  }
}

TEST(PureBoxes, AreNoneForNoPointsAndSmallForTwinsOfBothKinds) {
  const std::vector<Point> points = {{1, 2, 3, 0}, {1, 2, 3, 0}, {1, 2, 3, 0}};
  EXPECT_TRUE(pure_boxes(points, {}, {0, 1}).empty());
  EXPECT_EQ(pure_boxes(points, {0, 1}, {2}).size(), 2U);
}

}  // namespace
}  // namespace mosbench
