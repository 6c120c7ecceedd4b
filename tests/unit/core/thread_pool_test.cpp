#include "core/base/thread_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace mosbench {
namespace {

TEST(ThreadPool, VisitsEveryIndexExactlyOnce) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    ThreadPool pool(threads);
    ASSERT_EQ(pool.size(), threads);
    for (const std::size_t count : {0U, 1U, 2U, 63U, 64U, 65U, 1000U}) {
      for (const std::size_t grain : {0U, 1U, 3U, 64U, 5000U}) {
        std::vector<std::atomic<int>> visits(count);
        std::atomic<bool> good_range{true};
        pool.for_ranges(count, grain, [&](std::size_t begin, std::size_t end, unsigned thread) {
          const std::size_t most = grain == 0 ? 1 : grain;
          if (begin >= end || end > count || end - begin > most || thread >= threads) {
            good_range = false;
          }
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        EXPECT_TRUE(good_range);
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1);
      }
    }
  }
}

TEST(ThreadPool, RethrowsTheLowestRangesExceptionAndGoesOn) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 200; ++repeat) {
      std::string message;
      try {
        pool.for_ranges(100, 1, [&](std::size_t begin, std::size_t, unsigned) {
          if (begin >= 3) throw std::runtime_error(std::to_string(begin));
        });
      } catch (const std::runtime_error& error) {
        message = error.what();
      }
      ASSERT_EQ(message, "3");
    }
    std::atomic<int> visits{0};
    pool.for_ranges(50, 1, [&](std::size_t, std::size_t, unsigned) { ++visits; });
    EXPECT_EQ(visits, 50);
  }
}

TEST(ThreadPool, PoolsInSeveralThreadsDoNotDisturbEachOther) {
  std::vector<std::size_t> sums(4);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < sums.size(); ++t) {
      threads.emplace_back([&sums, t] {
        ThreadPool pool(3);
        for (int repeat = 0; repeat < 100; ++repeat) {
          std::atomic<std::size_t> sum{0};
          pool.for_ranges(100, 7, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t i = begin; i < end; ++i) sum += i;
          });
          sums[t] += sum;
        }
      });
    }
  }
  EXPECT_THAT(sums, testing::Each(100U * 4950U));
}

}  // namespace
}  // namespace mosbench
