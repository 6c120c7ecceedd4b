#include "core/methods/hmm_mos/otsu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/unit/core/otsu_of.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// Otsu's threshold as the authors' program computes it, on the plain list of values.
std::optional<double> literal_otsu(const std::vector<int>& values) {
  if (values.empty()) return std::nullopt;
  const double lo = *std::min_element(values.begin(), values.end());
  const double hi = *std::max_element(values.begin(), values.end());
  const double b = (hi - lo) / 100;
  std::vector<double> c(100, 0.0);
  for (const int s : values) {
    if (s - lo < 1e-3) {
      ++c[0];
    } else if (hi - s < 1e-3) {
      ++c[99];
    } else {
      ++c[static_cast<std::size_t>(std::ceil((s - lo) / b) - 1)];
    }
  }
  double total = 0, m1 = 0, below = 0, sum = 0, best = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    total += c[i];
    m1 += static_cast<double>(i) * c[i];
  }
  int level = -1;
  for (std::size_t i = 0; i < 100; ++i) {
    if (below > 0 && total - below > 0) {
      const double difference = sum / below - (m1 - sum) / (total - below);
      const double between = below * (total - below) * (difference * difference);
      if (between >= best) {
        best = between;
        level = static_cast<int>(i) + 1;
      }
    }
    below += c[i];
    sum += static_cast<double>(i) * c[i];
  }
  if (level < 0) return std::nullopt;
  return lo + (level - 1) * (hi - lo) / 100;
}

TEST(Otsu, NothingToSeparateHasNoThreshold) {
  EXPECT_EQ(otsu_threshold({}), std::nullopt);
  EXPECT_EQ(otsu_of({7}), std::nullopt);
  EXPECT_EQ(otsu_of({4, 4, 4, 4}), std::nullopt);
  EXPECT_EQ(otsu_threshold(std::vector<ValueCount>{{5, 3}, {9, 0}, {1, 0}}), std::nullopt);
}

/// Between two values every level separates them equally well: the last one wins, which is bin
/// 99's.
TEST(Otsu, LaterTiesWin) {
  EXPECT_EQ(otsu_of({0, 100}), 99.0);
  EXPECT_EQ(otsu_of({0, 0, 0, 10}), 0 + 99 * 10.0 / 100);
  EXPECT_EQ(otsu_of({-50, 150}), -50 + 99 * 2.0);
}

/// Values 0 0 1 100: bins 0 0 0 99. Levels 2 to 99 tie, so T = 99 selects the one at 100 alone.
TEST(Otsu, HandWorkedHistogram) {
  EXPECT_EQ(otsu_of({0, 0, 1, 100}), 99.0);
  // 0 0 0 50 50 100: bins 0 and 49 and 99. Splitting below 50: 3*3*(74.. - ..)^2; see the twin.
  const std::vector<int> three{0, 0, 0, 50, 50, 100};
  // Weights 3 | 3, means 0 and (49 + 49 + 99) / 3: 9 * 65.67^2 = 38809 against 5 * 79.4^2 = 31522.
  EXPECT_EQ(otsu_of(three), 49.0);
}

TEST(Otsu, CountsAreRepetitions) {
  EXPECT_EQ(otsu_threshold(std::vector<ValueCount>{{3, 2}, {0, 40}, {3, 1}, {17, 4}, {5, 0}}), [] {
    std::vector<int> values(40, 0);
    values.insert(values.end(), {3, 3, 3, 17, 17, 17, 17});
    return literal_otsu(values);
  }());
}

TEST(Otsu, EqualsTheLiteralTranscription) {
  std::mt19937 random(51);
  std::size_t with_level = 0, above_lowest = 0;
  for (int round = 0; round < 5000; ++round) {
    const unsigned spread = 1U << (random() % 12);
    const int base = round % 3 == 0 ? static_cast<int>(random() % 50) - 25 : 0;
    std::vector<int> values(random() % 60);
    for (int& value : values) {
      value = base + static_cast<int>(random() % 3 == 0 ? random() % spread : random() % 3);
    }
    const std::optional<double> expected = literal_otsu(values);
    ASSERT_EQ(otsu_of(values), expected) << "round " << round;
    with_level += expected.has_value();
    above_lowest += expected.value_or(0) > base + 1;
  }
  EXPECT_GT(with_level, 3000U);
  EXPECT_GT(above_lowest, 1000U);
}

/// Scores just inside the bins' edges: (s - lo) / b is whole for every value when hi - lo = 100.
TEST(Otsu, ValuesOnBinEdgesBelongToTheLowerBin) {
  for (const int high : {50, 100, 200, 300, 700, 1000}) {
    for (int middle = 1; middle < high; ++middle) {
      const std::vector<int> values{0, 0, 0, middle, middle, high};
      ASSERT_EQ(otsu_of(values), literal_otsu(values)) << middle << " of " << high;
    }
  }
}

}  // namespace
}  // namespace mosbench
