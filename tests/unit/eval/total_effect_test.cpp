#include "eval/statistics/total_effect.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

double number_of(std::uint64_t stream, std::uint64_t n) { return uniform(random_word(stream, n)); }

/// Base and varied values of 3 x + 1 y, of which `which` is drawn anew.
std::pair<std::vector<double>, std::vector<double>> linear_values(int which, std::size_t points) {
  std::vector<double> base, varied;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = number_of(1, i), y = number_of(2, i);
    base.push_back(3 * x + y);
    varied.push_back(3 * (which == 0 ? number_of(3, i) : x) + (which == 1 ? number_of(4, i) : y));
  }
  return {base, varied};
}

TEST(TotalEffect, OfASumIsTheShareOfTheVariance) {
  for (const int which : {0, 1}) {
    const double expected = which == 0 ? 0.9 : 0.1;  // 9 of 10, and 1 of 10, of the variance
    const auto [base, varied] = linear_values(which, 4000);
    const auto effect = total_effect(base, varied);
    ASSERT_TRUE(effect);
    EXPECT_NEAR(effect->index, expected, 0.04);
    EXPECT_LT(effect->interval.low, expected);
    EXPECT_GT(effect->interval.high, expected);
    EXPECT_LT(effect->interval.high - effect->interval.low, 0.1);
  }
}

TEST(TotalEffect, HasAnIntervalThatShrinksWithPoints) {
  const auto width = [](std::size_t points) {
    const auto [base, varied] = linear_values(0, points);
    const Interval interval = total_effect(base, varied)->interval;
    return interval.high - interval.low;
  };
  EXPECT_GT(width(50), 3 * width(2000));
}

TEST(TotalEffect, IsUnknownWithoutPointsOrVariance) {
  const std::vector<double> two = {1, 2}, same = {1, 1, 1};
  EXPECT_FALSE(total_effect(two, two));
  EXPECT_FALSE(total_effect(same, same));
  EXPECT_THROW(total_effect(two, same), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench
