#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/statistics/run_statistics.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;

TEST(ParetoFront, HoldsRunsThatNoOtherBeats) {
  const std::vector<IouAndTime> runs = {{0.8, 10.0}, {0.7, 5.0}, {0.7, 6.0}, {0.6, 5.0}};
  EXPECT_THAT(pareto_front(runs), ElementsAre(true, true, false, false));
}

TEST(ParetoFront, HoldsBothOfTwoEqualRuns) {
  EXPECT_THAT(pareto_front(std::vector<IouAndTime>{{0.8, 10.0}, {0.8, 10.0}}),
              ElementsAre(true, true));
}

TEST(ParetoFront, LeavesOutRunsThatLackANumberWhichBeatNone) {
  const std::vector<IouAndTime> runs = {{0.9, std::nullopt}, {std::nullopt, 1.0}, {0.8, 10.0}};
  EXPECT_THAT(pareto_front(runs), ElementsAre(false, false, true));
}

}  // namespace
}  // namespace mosbench
