#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "eval/static_map/map_score.hpp"

namespace mosbench {
namespace {

TEST(MapAccuracy, OfAMapByHand) {
  // Three of four static points are kept, one of two dynamic ones is removed.
  const std::vector<Point> truth = {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0},
                                    {3, 0, 0, 0}, {4, 0, 0, 1}, {5, 0, 0, 1}};
  const std::vector<bool> dynamic = {false, false, false, false, true, true};
  const std::vector<Point> map = {{0, 0.04F, 0, 7}, {1, 0, 0, 7}, {2, 0, -0.03F, 7}, {4, 0, 0, 7}};
  const MapCounts counts = count_kept(map, truth, dynamic);
  EXPECT_EQ(counts.static_points, 4U);
  EXPECT_EQ(counts.kept_static, 3U);
  EXPECT_EQ(counts.dynamic_points, 2U);
  EXPECT_EQ(counts.removed_dynamic, 1U);
  EXPECT_DOUBLE_EQ(counts.static_accuracy().value(), 0.75);
  EXPECT_DOUBLE_EQ(counts.dynamic_accuracy().value(), 0.5);
  EXPECT_DOUBLE_EQ(counts.associated_accuracy().value(), std::sqrt(0.375));
  EXPECT_DOUBLE_EQ(counts.harmonic_accuracy().value(), 0.6);
}

TEST(MapAccuracy, KeepsAPointExactlyAsFarAsAllowed) {
  const std::vector<Point> truth = {{0, 0, 0, 0}};
  const std::vector<bool> dynamic = {false};
  const float beyond = std::nextafter(0.05F, 1.0F);
  EXPECT_EQ(count_kept(std::vector<Point>{{0.05F, 0, 0, 0}}, truth, dynamic).kept_static, 1U);
  EXPECT_EQ(count_kept(std::vector<Point>{{beyond, 0, 0, 0}}, truth, dynamic).kept_static, 0U);
}

TEST(MapAccuracy, LosesAllToAnEmptyMapAndToOneThatIsNotFinite) {
  const std::vector<Point> truth = {{0, 0, 0, 0}, {1, 0, 0, 1}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<Point>& map : {std::vector<Point>{}, {{nan, 0, 0, 0}}}) {
    const MapCounts counts = count_kept(map, truth, {false, true});
    EXPECT_EQ(counts.static_accuracy(), 0.0);
    EXPECT_EQ(counts.dynamic_accuracy(), 1.0);
    EXPECT_EQ(counts.harmonic_accuracy(), 0.0);
  }
}

TEST(MapAccuracy, IsUndefinedForWhatTheTruthLacks) {
  const std::vector<Point> point = {{0, 0, 0, 0}};
  const MapCounts counts = count_kept(point, point, {false});
  EXPECT_EQ(counts.static_accuracy(), 1.0);
  EXPECT_FALSE(counts.dynamic_accuracy());
  EXPECT_FALSE(counts.associated_accuracy());
  EXPECT_FALSE(counts.harmonic_accuracy());
}

TEST(MapAccuracy, EqualsComparingAllPairs) {
  std::mt19937 random(3);
  const auto cloud = [&](std::size_t points) {
    std::uniform_real_distribution<float> coordinate(100.0F, 101.0F);
    std::vector<Point> all(points);
    for (Point& p : all) p = {coordinate(random), coordinate(random), coordinate(random), 0};
    return all;
  };
  const std::vector<Point> map = cloud(700), truth = cloud(900);
  std::vector<bool> dynamic(truth.size());
  for (std::size_t i = 0; i < dynamic.size(); ++i) dynamic[i] = random() % 3 == 0;
  MapCounts expected;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    bool kept = false;
    for (const Point& p : map) {
      const float x = p.x - truth[i].x, y = p.y - truth[i].y, z = p.z - truth[i].z;
      kept = kept || std::sqrt(x * x + y * y + z * z) <= 0.05F;
    }
    ++(dynamic[i] ? expected.dynamic_points : expected.static_points);
    expected.kept_static += !dynamic[i] && kept;
    expected.removed_dynamic += dynamic[i] && !kept;
  }
  const MapCounts counts = count_kept(map, truth, dynamic);
  EXPECT_EQ(counts.kept_static, expected.kept_static);
  EXPECT_EQ(counts.removed_dynamic, expected.removed_dynamic);
  EXPECT_GT(expected.kept_static, 100U);
  EXPECT_GT(expected.removed_dynamic, 100U);
}

}  // namespace
}  // namespace mosbench
