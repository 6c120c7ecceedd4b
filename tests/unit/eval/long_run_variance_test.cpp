#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "eval/statistics/uncertainty.hpp"

namespace mosbench {
namespace {

using Series = std::vector<double>;

/// An autoregressive process with noise that any other program can make as well.
Series remembering(std::uint32_t seed, std::size_t scans, double memory, double scale) {
  Series series;
  double value = 0.0;
  while (series.size() < scans) {
    seed = (seed * 1103515245U + 12345U) & 0x7FFFFFFFU;
    value = memory * value + static_cast<double>(seed) / 2147483648.0 - 0.5;
    series.push_back(scale * value);
  }
  return series;
}

SumUncertainty uncertainty_of_series(const std::vector<Series>& series) {
  return long_run_uncertainty(series, neighbour_correlation(series));
}

/// The numbers are those of another program, in Python, by the same formulas. Of the two sequences
/// the first has more scans, the second more spread.
TEST(LongRunVariance, IsThatOfAnotherProgram) {
  const std::vector<Series> half = {remembering(1, 600, 0.5, 1.0), remembering(2, 240, 0.5, 3.0)};
  EXPECT_NEAR(uncertainty_of_series(half).standard_error, 16.843880950789092, 1e-9);
  EXPECT_NEAR(uncertainty_of_series(half).freedom, 3.131435981412699, 1e-9);
  const std::vector<Series> most = {remembering(1, 600, 0.8, 1.0), remembering(2, 240, 0.8, 3.0)};
  EXPECT_NEAR(uncertainty_of_series(most).standard_error, 42.429040183582416, 1e-9);
  EXPECT_NEAR(uncertainty_of_series(most).freedom, 3.304771157423653, 1e-9);
}

TEST(LongRunVariance, TakesNoCoefficientFasterThanTheMemory) {
  const std::vector<Series> series = {remembering(1, 600, 0.8, 1.0)};
  const double memory = neighbour_correlation(series).bound(3.25);
  const double corner = (1.0 - memory) / std::sqrt(memory);
  const double slow = std::floor(0.25 * corner * 600.0 / std::numbers::pi);
  ASSERT_GT(slow, 2.0);
  ASSERT_LT(slow, std::floor(0.1 * std::pow(600.0, 2.0 / 3.0)));
  EXPECT_NEAR(uncertainty_of_series(series).freedom, slow, 1e-9);
}

TEST(LongRunVariance, DoesNotChangeWithAConstant) {
  const std::vector<Series> series = {remembering(1, 600, 0.5, 1.0)};
  std::vector<Series> raised = series;
  for (double& value : raised[0]) value += 1000.0;
  EXPECT_NEAR(uncertainty_of_series(raised).standard_error,
              uncertainty_of_series(series).standard_error, 1e-6);
}

TEST(LongRunVariance, NeedsSequencesThatAreLongComparedWithTheirMemory) {
  const std::vector<Series> series = {remembering(1, 90, 0.9, 1.0), remembering(2, 110, 0.9, 3.0)};
  EXPECT_EQ(uncertainty_of_series(series).unknown,
            "neighbouring scans are too alike for 100 per sequence, expected about 767");
}

TEST(LongRunVariance, NeedsSeveralSequencesOfFortyScans) {
  std::vector<Series> series;
  for (unsigned seed = 1; seed <= 5; ++seed) series.push_back(remembering(seed, 39, 0.2, 1.0));
  EXPECT_EQ(uncertainty_of_series(series).unknown,
            "5 sequences of 39 scans in the mean, expected at least 40 in each");
}

TEST(LongRunVariance, TakesOneCoefficientOfEachOfSeveralShortSequences) {
  std::vector<Series> series;
  for (unsigned seed = 1; seed <= 10; ++seed) series.push_back(remembering(seed, 40, 0.5, 1.0));
  EXPECT_NEAR(uncertainty_of_series(series).standard_error, 10.074197414390923, 1e-9);
  EXPECT_NEAR(uncertainty_of_series(series).freedom, 9.03070126395113, 1e-9);
}

}  // namespace
}  // namespace mosbench
