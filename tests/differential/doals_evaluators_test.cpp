// Slow twins of the two programs that evaluate DOALS, written line by line after their sources,
// compared bit by bit on random labels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "eval/protocols/metrics.hpp"
#include "tests/random_scans.hpp"

namespace mosbench {
namespace {

constexpr int kRows = 10;

std::vector<RandomScan> ten_scans(unsigned seed, std::size_t points) {
  std::mt19937 random(seed);
  std::vector<RandomScan> scans;
  for (int k = 0; k < kRows; ++k) scans.push_back(random_scan(random, points, kAllIds));
  return scans;
}

std::vector<int> moving_indices(const std::vector<std::uint32_t>& labels) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if ((labels[i] & 0xFFFFU) >= 251) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

struct IndexCounts {
  int tp = 0, fp = 0, fn = 0;
  double iou = 0.0;
};

/// evalIndFile.cpp: sets of indices; the truth is cut by range, the estimate is not.
IndexCounts eval_ind_file(const RandomScan& scan, std::vector<int> estimate, double min_range,
                          double max_range) {
  std::unordered_map<int, int> truth_indices, estimate_indices, all_indices;
  for (const int index : moving_indices(scan.truth)) {
    const Point& point = scan.points[static_cast<std::size_t>(index)];
    const double norm = std::sqrt(std::pow(static_cast<double>(point.x), 2) +
                                  std::pow(static_cast<double>(point.y), 2) +
                                  std::pow(static_cast<double>(point.z), 2));
    if (norm >= min_range && norm <= max_range) truth_indices[index] = all_indices[index] = 1;
  }
  for (const int index : estimate) estimate_indices[index] = all_indices[index] = 1;
  IndexCounts counts;
  for (const auto& [index, one] : all_indices) {
    const bool in_truth = truth_indices.contains(index);
    const bool in_estimate = estimate_indices.contains(index);
    if (in_truth && in_estimate) ++counts.tp;
    if (in_truth && !in_estimate) ++counts.fn;
    if (!in_truth && in_estimate) ++counts.fp;
  }
  counts.iou =
      static_cast<double>(counts.tp) / static_cast<double>(counts.tp + counts.fn + counts.fp) * 100;
  return counts;
}

TEST(EvalIndFile, GivesTheSameAsItsTwin) {
  const Protocol& protocol = protocol_named("doals-hmm");
  std::mt19937 random(7);
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const RangeGate limits = seed % 3 == 0 ? RangeGate{0.5, 120.0} : RangeGate{0.5, 20.0};
    double iou_sum = 0.0;
    std::vector<Confusion> counts;
    for (const RandomScan& scan : ten_scans(seed, 20 + seed * 10)) {
      std::vector<int> estimate = moving_indices(scan.prediction);
      ASSERT_FALSE(estimate.empty());
      estimate.insert(estimate.end(), estimate.begin(), estimate.begin() + 1);
      std::ranges::shuffle(estimate, random);
      const IndexCounts twin = eval_ind_file(scan, estimate, limits.min_m, limits.max_m);
      iou_sum += twin.iou;
      counts.push_back(score_scan(protocol, scan.truth, scan.prediction, scan.points, limits));
      EXPECT_EQ(static_cast<int>(counts.back().tp), twin.tp);
      EXPECT_EQ(static_cast<int>(counts.back().fp), twin.fp);
      EXPECT_EQ(static_cast<int>(counts.back().fn), twin.fn);
    }
    const Summary summary = summarize(protocol, counts);
    EXPECT_EQ(summary.published_iou, iou_sum / 10.0);
    std::ostringstream printed;
    printed << std::fixed << std::setprecision(2) << iou_sum / 10.0;
    EXPECT_EQ(summary.published_text, printed.str());
  }
}

struct DynabloxScores {
  unsigned tp = 0, fp = 0, tn = 0, fn = 0;
  float iou = 0.0F;
};

/// Dynablox's evaluator.cpp at point level: range and ratio in float32.
DynabloxScores dynablox_scores(const RandomScan& scan, float min_range, float max_range) {
  DynabloxScores scores;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Point& point = scan.points[i];
    const float norm = std::sqrt(point.x * point.x + point.y * point.y + point.z * point.z);
    if (!(norm >= min_range && norm <= max_range)) continue;
    const bool is_dynamic = (scan.prediction[i] & 0xFFFFU) >= 251;
    const bool truth_dynamic = (scan.truth[i] & 0xFFFFU) >= 251;
    if (is_dynamic && truth_dynamic) ++scores.tp;
    if (is_dynamic && !truth_dynamic) ++scores.fp;
    if (!is_dynamic && !truth_dynamic) ++scores.tn;
    if (!is_dynamic && truth_dynamic) ++scores.fn;
  }
  const unsigned all = scores.tp + scores.fp + scores.fn;
  scores.iou = all == 0 ? 1.0F : static_cast<float>(scores.tp) / static_cast<float>(all);
  return scores;
}

/// One cell of scores.csv, written by an ostream and read back as a double.
double through_csv(float value) {
  std::ostringstream out;
  out << value;
  return std::stod(out.str());
}

TEST(Dynablox, GivesTheSameAsItsTwin) {
  const Protocol& protocol = protocol_named("doals-dynablox");
  std::size_t empty_scans = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    // 0.3 and 14.1 m differ between float and double.
    const bool odd = seed % 2 == 1;
    const RangeGate limits = odd ? RangeGate{0.5, 20.0} : RangeGate{0.3, 14.1};
    double sum = 0.0;
    std::vector<Confusion> counts;
    for (const RandomScan& scan : ten_scans(seed, seed % 4 == 0 ? 3 : seed * 10)) {
      const DynabloxScores twin = dynablox_scores(scan, odd ? 0.5F : 0.3F, odd ? 20.0F : 14.1F);
      sum += through_csv(twin.iou) * 100.0;
      counts.push_back(score_scan(protocol, scan.truth, scan.prediction, scan.points, limits));
      EXPECT_EQ(counts.back().tp, twin.tp);
      EXPECT_EQ(counts.back().fp, twin.fp);
      EXPECT_EQ(counts.back().tn, twin.tn);
      EXPECT_EQ(counts.back().fn, twin.fn);
      if (twin.tp + twin.fp + twin.fn == 0) ++empty_scans;
    }
    const Summary summary = summarize(protocol, counts);
    EXPECT_EQ(summary.published_iou, sum / kRows);
    std::ostringstream printed;
    printed << std::fixed << std::setprecision(1) << sum / kRows;
    EXPECT_EQ(summary.published_text, printed.str());
  }
  EXPECT_GT(empty_scans, 0U);
}

TEST(Dynablox, ComparesRangesWithLimitsRoundedToFloat) {
  const Protocol& protocol = protocol_named("doals-dynablox");
  ASSERT_GT(static_cast<double>(14.1F), 14.1);
  ASSERT_LT(static_cast<double>(0.7F), 0.7);
  for (const float range : {14.1F, 0.7F}) {
    const RandomScan scan{{251}, {251}, {{range, 0.0F, 0.0F, 0.0F}}};
    ASSERT_EQ(dynablox_scores(scan, 0.7F, 14.1F).tp, 1U);
    EXPECT_EQ(
        score_scan(protocol, scan.truth, scan.prediction, scan.points, RangeGate{0.7, 14.1}).tp,
        1U);
  }
}

TEST(Dynablox, AveragesTheSixDigitsOfItsFile) {
  const std::vector<Confusion> scan = {{.tp = 1, .fn = 11}};
  ASSERT_EQ(through_csv(1.0F / 12.0F), 0.0833333);
  EXPECT_EQ(summarize(protocol_named("doals-dynablox"), scan).published_iou, 0.0833333 * 100.0);
}

}  // namespace
}  // namespace mosbench
