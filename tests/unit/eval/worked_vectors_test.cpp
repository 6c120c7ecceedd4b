// Small cases worked by hand from the rules of each benchmark's own program.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "eval/protocols/metrics.hpp"
#include "tests/unit/eval/confusions.hpp"

namespace mosbench {
namespace {

Summary summary_of(std::string_view protocol, const Confusion& scan) {
  return summarize(protocol_named(protocol), std::vector{scan});
}

TEST(WorkedVectors, FirstMixesAllIds) {
  const Labels truth = {0, 9, 251, 252, 1};
  const Labels prediction = {251, 251, 251, 9, 9};
  const Confusion kitti = score("semantickitti-mos", truth, prediction);
  EXPECT_EQ(kitti, (Confusion{.tp = 1, .fp = 1, .fn = 1, .ignored = 2}));
  EXPECT_EQ(summary_of("semantickitti-mos", kitti).published_text, "0.333");
  const Confusion sipailou = score("sipailou", truth, prediction);
  EXPECT_EQ(sipailou, (Confusion{.tp = 1, .fp = 2, .fn = 1, .tn = 1, .unknown_ids = 1}));
  EXPECT_EQ(moving_iou(sipailou), 0.25);
  const Confusion mapmos = score("mapmos", truth, prediction);
  EXPECT_EQ(mapmos, (Confusion{.tp = 1, .fp = 1, .fn = 1, .ignored = 2}));
  EXPECT_EQ(moving_iou(mapmos), 1.0 / 3.0);
  const Confusion apollo = score("mapmos-apollo", truth, prediction);
  EXPECT_EQ(apollo, (Confusion{.tp = 1, .fp = 2, .fn = 1, .tn = 1}));
  EXPECT_EQ(moving_iou(apollo), 0.25);
}

TEST(WorkedVectors, SecondMissesAMovingPointByLeavingItUnlabelled) {
  for (const std::string_view name : {"semantickitti-mos", "sipailou"}) {
    const Confusion counts = score(name, {251}, {0});
    EXPECT_EQ(counts, Confusion{.fn = 1}) << name;
    EXPECT_EQ(moving_iou(counts), 0.0) << name;
  }
}

TEST(WorkedVectors, ThirdHasNothingMovingAndEveryProgramSaysSomethingElse) {
  const Labels still = {9, 9};
  for (const std::string_view name :
       {"semantickitti-mos", "mapmos", "doals-dynablox", "doals-hmm"}) {
    const Summary summary = summary_of(name, score(name, still, still));
    EXPECT_EQ(summary[Metric::kIou], std::nullopt) << name;
    EXPECT_EQ(summary.undefined_scans, 1U) << name;
  }
  const auto published = [&](std::string_view name) {
    return summary_of(name, score(name, still, still));
  };
  EXPECT_EQ(published("semantickitti-mos").published_text, "0.000");
  EXPECT_EQ(published("mapmos").published_text, "nan");
  EXPECT_EQ(published("doals-dynablox").published_iou, 100.0);
  EXPECT_EQ(published("doals-dynablox").published_text, "100.0");
  EXPECT_TRUE(std::isnan(published("doals-hmm").published_iou));
  EXPECT_EQ(published("doals-hmm").published_text, "nan");
}

TEST(WorkedVectors, FourthCutsTheRangeOfTruthOrOfBoth) {
  std::vector<Point> points;
  for (const float range : {0.3F, 5.0F, 19.99F, 20.0F, 20.01F}) {
    points.push_back({0.0F, range, 0.0F, 0.0F});
  }
  const Labels truth = {251, 251, 9, 251, 251};
  const Labels prediction = {9, 251, 251, 9, 251};
  const Confusion hmm = score_scan(protocol_named("doals-hmm"), truth, prediction, points);
  EXPECT_EQ(hmm, (Confusion{.tp = 1, .fp = 2, .fn = 1, .tn = 1}));
  EXPECT_EQ(summary_of("doals-hmm", hmm).published_text, "25.00");
  const Confusion dynablox =
      score_scan(protocol_named("doals-dynablox"), truth, prediction, points);
  EXPECT_EQ(dynablox, (Confusion{.tp = 1, .fp = 1, .fn = 1, .ignored = 2}));
  EXPECT_EQ(summary_of("doals-dynablox", dynablox).published_text, "33.3");
}

TEST(WorkedVectors, FifthTellsTheMeanOfScansFromThePooledNumber) {
  const std::vector<Confusion> scans = {{.tp = 1, .fn = 1}, {.tp = 90, .fp = 5, .fn = 5}};
  const Protocol& mean_protocol = protocol_named("doals-hmm");
  EXPECT_NEAR(summarize(mean_protocol, scans)[Metric::kIou].value(), 0.7, 1e-12);
  const Summary pooled = summarize(protocol_named("sipailou"), scans);
  EXPECT_EQ(pooled[Metric::kIou], 91.0 / 102.0);
  EXPECT_EQ(pooled.published_text, "0.892");
}

TEST(WorkedVectors, SixthReadsAnIdBelowAnInstanceNumber) {
  EXPECT_EQ(score("semantickitti-mos", {0x000500FB}, {251}), Confusion{.tp = 1});
}

TEST(WorkedVectors, SeventhLeavesOutWhereSceneFlowIsNotEvaluated) {
  const Labels truth = {9, 251, 251, 40, 259, 99, 0, 0x000300FB};
  const Labels prediction = {251, 251, 9, 251, 251, 9, 251, 251};
  const Confusion counts = score("sceneflow-dynamic-far", truth, prediction);
  EXPECT_EQ(counts, (Confusion{.tp = 2, .fp = 1, .fn = 1, .ignored = 4}));
  // Its program counts a scan in which nothing moves as 0.
  const Confusion still = score("sceneflow-dynamic-far", {9, 40}, {9, 9});
  const Summary summary =
      summarize(protocol_named("sceneflow-dynamic-far"), std::vector{counts, still});
  EXPECT_EQ(summary[Metric::kIou], 0.5);
  EXPECT_EQ(summary.undefined_scans, 1U);
  EXPECT_EQ(summary.published_iou, 2.0 / (4.0 + 1e-6) / 2.0);
  EXPECT_EQ(summary.published_text, "0.25");
}

TEST(WorkedVectors, EighthCountsSceneFlowInABoxAndNotByTheDistance) {
  constexpr float kOut = 35.000004F;
  const float nan = std::nanf("");
  const std::vector<Point> points = {{10, 0, 0, 0},   {35, -35, 99, 0}, {-kOut, 0, 0, 0},
                                     {0, kOut, 0, 0}, {nan, 0, 0, 0},   {0, 0, nan, 0}};
  const Labels truth = {251, 251, 9, 251, 251, 251};
  const Labels prediction = {251, 9, 251, 9, 251, 251};
  const Protocol& box = protocol_named("sceneflow-dynamic");
  EXPECT_EQ(score_scan(box, truth, prediction, points),
            (Confusion{.tp = 1, .fn = 1, .ignored = 4}));
  EXPECT_EQ(score_scan(box, truth, prediction, points, {0.0, 50.0}),
            (Confusion{.tp = 1, .fp = 1, .fn = 2, .ignored = 2}));
  EXPECT_EQ(score_scan(protocol_named("sceneflow-dynamic-far"), truth, prediction, points),
            (Confusion{.tp = 1, .fp = 1, .fn = 2, .ignored = 2}));
}

TEST(WorkedVectors, NinthFollowsTheScorerOfEachOfMDetectorsSets) {
  const Labels truth = {251, 251, 251, 9, 9, 9, 65535, 300};
  const Labels prediction = {251, 9, 0, 251, 9, 1, 251, 65535};
  EXPECT_EQ(score("mdetector", truth, prediction),
            (Confusion{.tp = 1, .fp = 1, .fn = 3, .tn = 2, .ignored = 1}));
  EXPECT_EQ(score("mdetector-kitti", truth, prediction),
            (Confusion{.tp = 1, .fp = 1, .fn = 1, .tn = 1, .ignored = 4, .unknown_ids = 3}));
  EXPECT_EQ(score("mdetector-nuscenes", {1000}, {9}), (Confusion{.ignored = 1}));
  EXPECT_EQ(score("mdetector-nuscenes", {1000, 9}, {9, 9}), (Confusion{.fn = 1, .tn = 1}));
}

TEST(WorkedVectors, TheAuthorsExampleAverages8922) {
  // Hauptgebaeude 1 at 20 m, per scan in percent, as HMM-MOS's README prints them.
  const std::array<std::uint64_t, 10> hundredths = {8368, 8427, 9689, 9283, 8591,
                                                    8622, 9540, 8770, 8192, 9733};
  std::vector<Confusion> scans;
  for (const std::uint64_t tp : hundredths) scans.push_back({.tp = tp, .fn = 10000 - tp});
  const Protocol& protocol = protocol_named("doals-hmm");
  const Summary summary = summarize(protocol, scans);
  EXPECT_EQ(summary.published_text, "89.22");
  EXPECT_EQ(summary.undefined_scans, 0U);
}

}  // namespace
}  // namespace mosbench
