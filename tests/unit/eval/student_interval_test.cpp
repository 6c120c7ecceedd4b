#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "eval/statistics/intervals.hpp"

namespace mosbench {
namespace {

// Of Student's t with 10 degrees of freedom, from a printed table.
constexpr double kQuantile975 = 2.228138852, kQuantile80 = 0.879057829;
// So many scans that do not resemble their neighbours have 10 coefficients.
constexpr std::size_t kScansOfSeries = 1100;

/// Scans of 1000 moving points; the share that is found is not that of the scan before.
SequenceCounts unlike_scans(unsigned seed, std::uint64_t least_found) {
  std::mt19937 random(seed);
  SequenceCounts scans(kScansOfSeries);
  for (Confusion& scan : scans) {
    scan.tp = least_found + random() % 100;
    scan.fn = 1000 - scan.tp;
  }
  return scans;
}

TEST(StudentInterval, IsAsWideAsTenCoefficientsAllow) {
  const std::vector<SequenceCounts> run = {unlike_scans(1, 500)};
  const Estimate iou = estimate(protocol_named("sipailou"), run)[Metric::kIou];
  const double half = kQuantile975 * iou.standard_error.value();
  EXPECT_GT(half, 1e-4);
  EXPECT_NEAR(iou.interval.value().low, iou.value.value() - half, 1e-9);
  EXPECT_NEAR(iou.interval.value().high, iou.value.value() + half, 1e-9);
}

TEST(StudentInterval, HasAPValueOfBothSidesAndADetectableDifferenceWithPower) {
  const std::vector<SequenceCounts> first = {unlike_scans(1, 500)};
  const std::vector<SequenceCounts> second = {unlike_scans(2, 501)};
  const Difference iou = paired_difference(protocol_named("sipailou"), first, second)[Metric::kIou];
  const double error = iou.standard_error.value();
  const double t = std::abs(iou.value.value()) / error;
  ASSERT_GT(t, 0.1);
  ASSERT_LT(t, 10.0);
  EXPECT_NEAR(iou.p_value.value(), 2.0 * student_probability(-t, 10.0), 1e-9);
  EXPECT_NEAR(iou.smallest_detectable.value(), (kQuantile975 + kQuantile80) * error, 1e-9);
}

TEST(StudentInterval, OfScansOfOneIouIsNothingHoweverManyPointsTheyHold) {
  std::vector<SequenceCounts> run = {unlike_scans(1, 500)};
  for (Confusion& scan : run[0]) {
    scan.fn = scan.tp;
    scan.tp *= 3;
  }
  const Estimate iou = estimate(protocol_named("sipailou"), run)[Metric::kIou];
  EXPECT_DOUBLE_EQ(iou.value.value(), 0.75);
  EXPECT_NEAR(iou.standard_error.value(), 0.0, 1e-12);
}

// Each sequence has half of the weight in the mean, and half of the coefficients it has alone.
TEST(StudentInterval, OfAMeanOfTwoSequencesIsNarrowerByTheSquareRootOfTwo) {
  const Protocol& protocol = protocol_named("helimos-all");
  ASSERT_EQ(protocol.aggregation, Aggregation::kMeanOfSequences);
  double one = 0.0;
  double mean = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SequenceCounts first = unlike_scans(seed, 500);
    const SequenceCounts second = unlike_scans(100 + seed, 500);
    one += *estimate(protocol, std::vector<SequenceCounts>{first})[Metric::kIou].standard_error;
    mean += *estimate(protocol, std::vector<SequenceCounts>{first, second})[Metric::kIou]
                 .standard_error;
  }
  EXPECT_NEAR(mean / one, std::sqrt(0.5), 0.15);
}

}  // namespace
}  // namespace mosbench
