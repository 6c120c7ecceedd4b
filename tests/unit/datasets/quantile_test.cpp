#include <gtest/gtest.h>

#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

TEST(Quantile, InterpolatesBetweenNeighbours) {
  const std::vector<double> values = {4.0, 1.0, 2.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.0, QuantileRule::kInterpolated), 1.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25, QuantileRule::kInterpolated), 1.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.75, QuantileRule::kInterpolated), 3.0);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0, QuantileRule::kInterpolated), 4.0);
}

TEST(Quantile, TakesTheNearestRank) {
  const std::vector<double> values = {4.0, 3.0, 1.0, 2.0};
  EXPECT_EQ(quantile(values, 0.0, QuantileRule::kNearestRank), 1.0);
  EXPECT_EQ(quantile(values, 0.5, QuantileRule::kNearestRank), 2.0);
  EXPECT_EQ(quantile(values, 0.51, QuantileRule::kNearestRank), 3.0);
  EXPECT_EQ(quantile(values, 1.0, QuantileRule::kNearestRank), 4.0);
}

TEST(Quantile, TakesTheUpperOfTwoInTheMiddle) {
  EXPECT_EQ(quantile({4.0, 3.0, 1.0, 2.0}, 0.5, QuantileRule::kUpper), 3.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.5, QuantileRule::kUpper), 2.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 1.0, QuantileRule::kUpper), 3.0);
}

TEST(Quantile, OfOneValueIsThatValue) {
  for (const QuantileRule rule :
       {QuantileRule::kInterpolated, QuantileRule::kNearestRank, QuantileRule::kUpper}) {
    for (const double q : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile({7.0}, q, rule), 7.0);
  }
}

}  // namespace
}  // namespace mosbench
