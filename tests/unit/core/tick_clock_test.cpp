#include <gtest/gtest.h>

#include <limits>

#include "core/methods/hmm_mos_plus/block_history.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// Returns the ticks of scans 0 to n - 1.
std::vector<std::uint32_t> first_ticks(const TickClock& clock, std::uint32_t n) {
  std::vector<std::uint32_t> ticks;
  std::uint32_t before = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const Tick tick = clock.of(k);
    if (k > 0) {
      EXPECT_EQ(tick.at, before + tick.steps) << k;
    }
    ticks.push_back(before = tick.at);
  }
  return ticks;
}

std::vector<std::uint32_t> ticks_of_ms(const std::vector<std::int64_t>& stamps_ms) {
  std::vector<std::int64_t> stamps_ns;
  for (const std::int64_t stamp_ms : stamps_ms) stamps_ns.push_back(stamp_ms * 1'000'000);
  return first_ticks(TickClock(stamps_ns), static_cast<std::uint32_t>(stamps_ms.size()));
}

using Ticks = std::vector<std::uint32_t>;

TEST(TickClock, CountsScansWithoutStampsAndAtTenHertz) {
  EXPECT_EQ(first_ticks(TickClock({}), 4), (Ticks{0, 1, 2, 3}));
  EXPECT_EQ(ticks_of_ms({5000}), Ticks{0});
  EXPECT_EQ(ticks_of_ms({50, 150, 250, 350}), (Ticks{0, 1, 2, 3}));
  EXPECT_EQ(ticks_of_ms({0, 118, 209, 330, 400, 511}), (Ticks{0, 1, 2, 3, 4, 5})) << "jitter";
}

TEST(TickClock, CountsTenthsOfASecondAtOtherRates) {
  EXPECT_EQ(ticks_of_ms({0, 200, 400, 600}), (Ticks{0, 2, 4, 6}));
  EXPECT_EQ(ticks_of_ms({0, 50, 100, 150, 200}), (Ticks{0, 0, 1, 1, 2}));
  EXPECT_EQ(ticks_of_ms({0, 150, 300, 450, 600}), (Ticks{0, 1, 3, 4, 6}));
}

TEST(TickClock, CountsScansThatAreMissing) {
  EXPECT_EQ(ticks_of_ms({0, 100, 200, 500, 600, 700}), (Ticks{0, 1, 2, 5, 6, 7}));
  EXPECT_EQ(ticks_of_ms({0, 200, 400, 1000, 1200, 1400}), (Ticks{0, 2, 4, 10, 12, 14}));
}

TEST(TickClock, TakesStampsThatTellNoTimeAsNone) {
  EXPECT_EQ(ticks_of_ms({7, 7, 7, 7}), (Ticks{0, 1, 2, 3}));
  EXPECT_EQ(ticks_of_ms({0, 100, 60, 200, 300}), (Ticks{0, 1, 2, 3, 4})) << "one goes back";
}

TEST(TickClock, GoesOnBehindTheLastStamp) {
  const std::vector<std::int64_t> stamps_ns = {0, 200'000'000, 400'000'000};
  EXPECT_EQ(first_ticks(TickClock(stamps_ns), 6), (Ticks{0, 2, 4, 5, 6, 7}));
}

TEST(TickClock, SurvivesAnyStamps) {
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  const std::vector<std::int64_t> stamps_ns = {kLowest, kHighest, kLowest, kHighest, 0, 1, 2, 3};
  const TickClock clock(stamps_ns);
  for (std::uint32_t k = 1; k < 8; ++k) EXPECT_GE(clock.of(k).steps, 0U);
}

TEST(TickClock, CountsPeriodsOfTheScans) {
  const std::vector<std::int64_t> stamps_ns = {0, 50'000'000, 100'000'000, 250'000'000,
                                               300'000'000};
  const TickClock clock(stamps_ns);
  std::vector<std::uint32_t> periods;
  for (std::uint32_t k = 0; k < 6; ++k) periods.push_back(clock.of(k).periods);
  EXPECT_EQ(periods, (std::vector<std::uint32_t>{1, 1, 1, 3, 1, 1}));
  EXPECT_DOUBLE_EQ(clock.of(3).period_s, 0.05);
  EXPECT_DOUBLE_EQ(clock.of(0).period_s, 0.05);
  EXPECT_DOUBLE_EQ(TickClock({}).of(3).period_s, 0.1);
}

}  // namespace
}  // namespace mosbench::hmm_mos_plus
