#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include "core/methods/hmm_mos/pipeline.hpp"
#include "tests/parity_cases.hpp"
#include "tests/sanitizers.hpp"

/// The labels of every parity case through Pipeline, point for point.
namespace mosbench::parity {
namespace {

const std::vector<unsigned> kThreads =
    kSanitized ? std::vector<unsigned>{2} : std::vector<unsigned>{1, 2, 7, 2};

/// The labels that one pipeline has released so far against those expected.
class Comparison {
 public:
  Comparison(const ParityCase& parity, unsigned threads)
      : threads_(threads), pipeline_(parity.config, {threads, parity.scans}) {}

  void push(const std::vector<Point>& points, const Pose& pose) {
    take(pipeline_.push(points, pose));
  }
  void finish() { take(pipeline_.finish()); }

  void expect_equal(const std::vector<std::vector<std::uint32_t>>& expected) const {
    ASSERT_EQ(labels_.size(), expected.size()) << threads_ << " threads";
    for (std::size_t k = 0; k < expected.size(); ++k) {
      ASSERT_EQ(labels_[k].size(), expected[k].size()) << "scan " << k;
      const auto differing =
          std::ranges::mismatch(labels_[k], expected[k]).in1 - labels_[k].begin();
      EXPECT_EQ(differing, std::ssize(labels_[k]))
          << "first differing point of scan " << k << " with " << threads_ << " threads";
    }
  }

  std::size_t moving_points() const {
    std::size_t moving = 0;
    for (const auto& scan : labels_) {
      moving += static_cast<std::size_t>(std::ranges::count(scan, kMovingLabel));
    }
    return moving;
  }

 private:
  void take(std::vector<LabelledScan> results) {
    for (LabelledScan& result : results) {
      EXPECT_EQ(result.scan_index, labels_.size());
      labels_.push_back(std::move(result.labels));
    }
  }

  unsigned threads_;
  Pipeline pipeline_;
  std::vector<std::vector<std::uint32_t>> labels_;
};

class ParityLabels : public testing::TestWithParam<ParityCase> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ParityLabels);

/// Four pipelines with 1, 2, 7 and again 2 threads take the scans in turn, so that a case is
/// read once and independent pipelines are shown not to disturb each other.
TEST_P(ParityLabels, EqualTheAuthorsOnEveryPointForAnyThreadCount) {
  const ParityCase& parity = GetParam();
  if (kSanitized && parity.name != "avia_params" && parity.name != "vlp16_params") {
    GTEST_SKIP() << "sanitized builds run avia_params and vlp16_params with 2 threads only";
  }
  const std::vector<Pose> poses = poses_of(parity);
  std::deque<Comparison> comparisons;
  for (const unsigned threads : kThreads) comparisons.emplace_back(parity, threads);
  std::vector<std::vector<std::uint32_t>> expected;
  std::size_t points_read = 0;
  for (std::size_t k = 0; k < parity.scans; ++k) {
    const std::vector<Point> points = points_of(parity, k);
    points_read += points.size();
    expected.push_back(expected_of(parity, k));
    for (Comparison& comparison : comparisons) comparison.push(points, poses[k]);
  }
  ASSERT_EQ(points_read, parity.points);
  ASSERT_GT(parity.predicted_moving_points, 0U);
  for (Comparison& comparison : comparisons) {
    comparison.finish();
    comparison.expect_equal(expected);
    EXPECT_EQ(comparison.moving_points(), parity.predicted_moving_points);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, ParityLabels, testing::ValuesIn(parity_cases()),
                         [](const testing::TestParamInfo<ParityCase>& test) {
                           return test.param.name;
                         });

TEST(ParityLabelsAre, ComparedWhereverTheOwnersFolderIs) {
  if (!shared_parity_folder()) GTEST_SKIP() << kSkipMessage;
  EXPECT_EQ(parity_cases().size(), 15U);
}

}  // namespace
}  // namespace mosbench::parity
