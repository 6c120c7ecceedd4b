#include "eval/protocols/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace mosbench {
namespace {

Summary summarize_as(std::string_view protocol, const std::vector<Confusion>& scans) {
  return summarize(protocol_named(protocol), scans);
}

TEST(MovingIou, IsTheShareOfTruePositives) {
  EXPECT_EQ(moving_iou({.tp = 3, .fp = 1, .fn = 2, .tn = 100}), 0.5);
}

TEST(MovingIou, IsUndefinedWithoutMovingPoints) {
  EXPECT_EQ(moving_iou({.tn = 100, .ignored = 5}), std::nullopt);
  EXPECT_EQ(moving_iou({.fp = 1}), 0.0);
  EXPECT_EQ(moving_iou({.fn = 1}), 0.0);
}

TEST(Precision, IsUndefinedWithoutAMovingPrediction) {
  EXPECT_EQ(precision({.tp = 1, .fp = 3, .fn = 9}), 0.25);
  EXPECT_EQ(precision({.fn = 9}), std::nullopt);
}

TEST(Recall, IsUndefinedWithoutAMovingTruth) {
  EXPECT_EQ(recall({.tp = 1, .fp = 9, .fn = 3}), 0.25);
  EXPECT_EQ(recall({.fp = 9}), std::nullopt);
}

TEST(F1, IsTheHarmonicMeanOfPrecisionAndRecall) {
  const Confusion counts{.tp = 6, .fp = 2, .fn = 6};
  const double p = *precision(counts);
  const double r = *recall(counts);
  EXPECT_DOUBLE_EQ(*metric_of(counts, Metric::kF1), 2.0 * p * r / (p + r));
  EXPECT_EQ(metric_of({.fp = 1, .fn = 1}, Metric::kF1), 0.0);
  EXPECT_EQ(metric_of({.tn = 1}, Metric::kF1), std::nullopt);
}

TEST(Confusion, AddsUpFieldByField) {
  Confusion sum{1, 2, 3, 4, 5, 6};
  sum += Confusion{10, 20, 30, 40, 50, 60};
  EXPECT_EQ(sum, (Confusion{11, 22, 33, 44, 55, 66}));
  EXPECT_EQ(sum.points(), 165U);
}

TEST(Summary, LeavesOutScansWithoutValueAndCountsThem) {
  const Summary summary = summarize_as("doals-hmm", {{.tp = 1, .fn = 1}, {.tn = 7}, {.tp = 2}});
  EXPECT_EQ(summary[Metric::kIou], 0.75);
  EXPECT_EQ(summary.iou_deviation, 0.25);
  EXPECT_EQ(summary.scans, 3U);
  EXPECT_EQ(summary.undefined_scans, 1U);
  EXPECT_TRUE(std::isnan(summary.published_iou));
  EXPECT_EQ(summary.published_text, "nan");
}

TEST(Summary, AveragesPrecisionOverTheScansThatPredictSomething) {
  const Summary summary = summarize_as("doals-hmm", {{.tp = 1, .fp = 1}, {.fn = 4}});
  EXPECT_EQ(summary[Metric::kPrecision], 0.5);
  EXPECT_EQ(summary[Metric::kRecall], 0.5);
  EXPECT_EQ(summary[Metric::kIou], 0.25);
  EXPECT_EQ(summary.undefined_scans, 0U);
}

TEST(Summary, TakesThePopulationDeviationAsNumpyDoes) {
  const Summary summary =
      summarize_as("doals-dynablox", {{.tp = 1, .fn = 3}, {.tp = 3, .fn = 1}, {.tp = 2, .fn = 2}});
  EXPECT_EQ(summary[Metric::kIou], 0.5);
  EXPECT_DOUBLE_EQ(*summary.iou_deviation, std::sqrt(0.125 / 3.0));
}

TEST(Summary, HasNoDeviationWhenPooled) {
  EXPECT_EQ(summarize_as("sipailou", {{.tp = 1}, {.fn = 1}}).iou_deviation, std::nullopt);
}

TEST(Summary, OfNoScanIsUndefinedForEveryProtocol) {
  for (const Protocol& protocol : protocols()) {
    const Summary summary = summarize(protocol, {});
    EXPECT_EQ(summary[Metric::kIou], std::nullopt) << protocol.name;
    EXPECT_EQ(summary[Metric::kPrecision], std::nullopt) << protocol.name;
    EXPECT_EQ(summary.scans, 0U) << protocol.name;
  }
}

TEST(Summary, OfMapmosIsUndefinedWithoutMovingTruthEvenWithFalsePositives) {
  const Summary summary = summarize_as("mapmos", {{.fp = 3, .tn = 5}});
  EXPECT_EQ(summary[Metric::kIou], std::nullopt);
  EXPECT_EQ(summary[Metric::kPrecision], std::nullopt);
  EXPECT_EQ(summary.published_text, "nan");
  EXPECT_EQ(summarize_as("semantickitti-mos", {{.fp = 3, .tn = 5}})[Metric::kIou], 0.0);
}

TEST(Summary, PrintsAsEachProgramDoes) {
  const std::vector<Confusion> scan = {{.tp = 5, .fp = 1, .fn = 0}};
  EXPECT_EQ(summarize_as("doals-hmm", scan).published_text, "83.33");
  EXPECT_EQ(summarize_as("doals-dynablox", scan).published_text, "83.3");
  EXPECT_EQ(summarize_as("semantickitti-mos", scan).published_text, "0.833");
  EXPECT_EQ(summarize_as("helimos-all", scan).published_text, "0.833");
  EXPECT_EQ(summarize_as("mapmos", scan).published_text, "83.333");
  EXPECT_EQ(summarize_as("mdetector", scan).published_text, "0.833333");
  EXPECT_EQ(summarize_as("mdetector", {{.tp = 1, .fn = 11}}).published_text, "0.0833333");
}

TEST(MeanOfSequences, IsThePlainMeanWhateverTheirSizes) {
  const Protocol& protocol = protocol_named("helimos-all");
  const std::vector<Summary> sensors = {summarize_as("helimos-all", {{.tp = 1, .fn = 1}}),
                                        summarize_as("helimos-all", {{.tp = 900}, {.fp = 100}})};
  const Summary average = mean_of_sequences(protocol, sensors);
  EXPECT_DOUBLE_EQ(*average[Metric::kIou], 0.7);
  EXPECT_EQ(average.published_text, "0.700");
  EXPECT_EQ(average.scans, 3U);
  EXPECT_EQ(average.pooled, (Confusion{.tp = 901, .fp = 100, .fn = 1}));
}

TEST(MeanOfSequences, IsUndefinedWhenOneSequenceIs) {
  const Protocol& protocol = protocol_named("moe");
  const std::vector<Summary> sequences = {summarize_as("moe", {{.tp = 1}}),
                                          summarize_as("moe", {{.tn = 1}})};
  const Summary average = mean_of_sequences(protocol, sequences);
  EXPECT_EQ(average[Metric::kIou], std::nullopt);
  EXPECT_EQ(average.published_text, "nan");
  EXPECT_EQ(mean_of_sequences(protocol, {})[Metric::kIou], std::nullopt);
}

}  // namespace
}  // namespace mosbench
