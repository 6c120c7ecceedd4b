#include "datasets/sequence/sensor_guess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace mosbench {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180.0;

std::vector<Point> rings(std::size_t count, double from_deg, double step_deg, double around_deg) {
  std::vector<Point> points;
  for (std::size_t ring = 0; ring < count; ++ring) {
    const double up = kRadians * (from_deg + step_deg * static_cast<double>(ring));
    for (double at_deg = 0.5 - around_deg / 2; at_deg < around_deg / 2; at_deg += 1.0) {
      const double range = 5.0 + static_cast<double>(ring);
      points.push_back({static_cast<float>(range * std::cos(up) * std::cos(kRadians * at_deg)),
                        static_cast<float>(range * std::cos(up) * std::sin(kRadians * at_deg)),
                        static_cast<float>(range * std::sin(up)), 0});
    }
  }
  return points;
}

TEST(SensorGuess, CountsRingsAndTheFieldOfView) {
  std::vector<Point> points = rings(16, -15, 2, 360);
  points.push_back({0, 0, 0, 0});
  points.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0, 0});
  const SensorGuess guess = guess_sensor(points);
  EXPECT_EQ(guess.returns, 16U * 360U);
  EXPECT_EQ(guess.missing, 2U);
  ASSERT_TRUE(guess.rings);
  EXPECT_EQ(*guess.rings, 16U);
  EXPECT_NEAR(guess.lowest_deg, -15, 0.01);
  EXPECT_NEAR(guess.highest_deg, 15, 0.01);
  EXPECT_EQ(guess.around_deg, 360);
  EXPECT_NEAR(guess.nearest_m, 5, 1e-5);
  EXPECT_NEAR(guess.farthest_m, 20, 1e-5);
  EXPECT_NEAR(guess.median_m, 12, 1.01);
  EXPECT_EQ(guess_sensor(rings(128, -22.5, 0.35, 90)).rings, 128U);
  EXPECT_NEAR(guess_sensor(rings(128, -22.5, 0.35, 90)).around_deg, 90, 1);
}

TEST(SensorGuess, CountsNoRingsWhereThereAreNone) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> around_m(-20.0F, 20.0F);
  std::vector<Point> points;
  for (int i = 0; i < 5000; ++i) {
    points.push_back({around_m(random), around_m(random), around_m(random), 0});
  }
  EXPECT_FALSE(guess_sensor(points).rings);
  EXPECT_EQ(guess_sensor({}).returns, 0U);
}

}  // namespace
}  // namespace mosbench
