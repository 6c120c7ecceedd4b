#include "core/methods/hmm_mos/pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <limits>
#include <stdexcept>
#include <thread>

#include "tests/small_world.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

Config easily_moving(int delay_scans = 0) {
  Config config = small_world_config();
  config.min_otsu_score = 1;
  config.delay_scans = delay_scans;
  return config;
}

std::vector<std::size_t> indices(const std::vector<LabelledScan>& results) {
  std::vector<std::size_t> scan_indices;
  for (const LabelledScan& result : results) scan_indices.push_back(result.scan_index);
  return scan_indices;
}

const std::vector<Point> kPoints(10, Point{2, 1, 0, 0});

TEST(Pipeline, OnlineReturnsEachScanAtOnce) {
  Pipeline pipeline(easily_moving());
  for (std::size_t k = 0; k < 6; ++k) {
    const std::vector<LabelledScan> results = pipeline.push(kPoints, Pose::Identity());
    EXPECT_THAT(indices(results), testing::ElementsAre(k));
    EXPECT_EQ(results[0].labels, std::vector<std::uint32_t>(10, kStaticLabel));
    EXPECT_EQ(results[0].threshold, std::nullopt);
  }
  EXPECT_TRUE(pipeline.finish().empty());
}

TEST(Pipeline, DelayHoldsScansBackAndFinishReleasesThem) {
  Pipeline pipeline(easily_moving(3), {1, 6});
  for (std::size_t k = 0; k < 6; ++k) {
    const std::vector<LabelledScan> results = pipeline.push(kPoints, Pose::Identity());
    if (k < 3) {
      EXPECT_TRUE(results.empty());
    } else {
      EXPECT_THAT(indices(results), testing::ElementsAre(k - 3));
    }
  }
  EXPECT_THAT(indices(pipeline.finish()), testing::ElementsAre(3, 4, 5));
  EXPECT_TRUE(pipeline.finish().empty());
}

TEST(Pipeline, DelayLongerThanTheSequenceLabelsEverythingStatic) {
  const SmallWorld world = small_world({.seed = 3, .scans = 12});
  ASSERT_GT(moving_points(labels_of(world, easily_moving(), Variant::kPaper2024)), 0U);
  const auto labels = labels_of(world, easily_moving(50), Variant::kPaper2024, 1, 12);
  EXPECT_EQ(labels.size(), 12U);
  EXPECT_EQ(moving_points(labels), 0U);
}

TEST(Pipeline, RefusesMoreScansThanAnnounced) {
  Pipeline pipeline(easily_moving(), {1, 2});
  pipeline.push(kPoints, Pose::Identity());
  pipeline.push(kPoints, Pose::Identity());
  EXPECT_THROW(pipeline.push(kPoints, Pose::Identity()), std::logic_error);
}

TEST(Pipeline, RefusesScansAfterFinish) {
  Pipeline pipeline(easily_moving(2));
  pipeline.push(kPoints, Pose::Identity());
  pipeline.finish();
  EXPECT_THROW(pipeline.push(kPoints, Pose::Identity()), std::logic_error);
}

TEST(Pipeline, RefusesImpossibleSettings) {
  EXPECT_THROW(Pipeline(easily_moving(), {0}), std::invalid_argument);
  EXPECT_THROW(Pipeline(of_variant(easily_moving(1), Variant::kRelease2025)),
               std::invalid_argument);
  Config config = easily_moving();
  config.kernel_width_voxels = 4;
  EXPECT_THROW(Pipeline{config}, std::invalid_argument);
  EXPECT_NO_THROW(Pipeline(of_variant(easily_moving(), Variant::kRelease2025)));
}

TEST(Pipeline, InterleavedPipelinesAreIndependent) {
  const SmallWorld a = small_world({.seed = 4}), b = small_world({.seed = 5, .walk_m = 0.3});
  const auto expected_a = labels_of(a, easily_moving(), Variant::kPaper2024);
  const auto expected_b = labels_of(b, easily_moving(), Variant::kRelease2025);
  ASSERT_GT(moving_points(expected_a), 0U);
  ASSERT_GT(moving_points(expected_b), 0U);
  Pipeline first(easily_moving(), {2});
  Pipeline second(of_variant(easily_moving(), Variant::kRelease2025), {3});
  for (std::size_t k = 0; k < a.scans.size(); ++k) {
    EXPECT_EQ(first.push(a.scans[k], a.poses[k])[0].labels, expected_a[k]);
    EXPECT_EQ(second.push(b.scans[k], b.poses[k])[0].labels, expected_b[k]);
  }
}

TEST(Pipeline, RunsInSeveralThreadsAtOnce) {
  const SmallWorld world = small_world({.seed = 6});
  const auto expected = labels_of(world, easily_moving(2), Variant::kPaper2024, 1, 16);
  ASSERT_GT(moving_points(expected), 0U);
  std::vector<std::vector<std::vector<std::uint32_t>>> labels(3);
  {
    std::vector<std::jthread> threads;
    for (auto& own : labels) {
      threads.emplace_back(
          [&] { own = labels_of(world, easily_moving(2), Variant::kPaper2024, 2, 16); });
    }
  }
  EXPECT_THAT(labels, testing::Each(expected));
}

TEST(Pipeline, ObservesAScanWhileTheOneBeforeIsPushed) {
  const SmallWorld world = small_world({.seed = 11, .defects = true});
  for (const int delay : {0, 3}) {
    const auto expected =
        labels_of(world, easily_moving(delay), Variant::kPaper2024, 1, world.scans.size());
    ASSERT_GT(moving_points(expected), 0U);
    for (const unsigned threads : {1U, 2U, 5U}) {
      Pipeline pipeline(easily_moving(delay), {threads, world.scans.size()});
      const auto observe = [&](std::size_t k) {
        return std::async(std::launch::async,
                          [&, k] { return pipeline.observe(world.scans[k], world.poses[k]); });
      };
      std::vector<std::vector<std::uint32_t>> labels;
      const auto take = [&](std::vector<LabelledScan> results) {
        for (LabelledScan& result : results) labels.push_back(std::move(result.labels));
      };
      std::future<std::unique_ptr<Observed>> upcoming = observe(0);
      for (std::size_t k = 0; k < world.scans.size(); ++k) {
        std::unique_ptr<Observed> observed = upcoming.get();
        if (k + 1 < world.scans.size()) upcoming = observe(k + 1);
        take(pipeline.push(std::move(observed)));
      }
      take(pipeline.finish());
      EXPECT_EQ(labels, expected) << threads << " threads, delay " << delay;
    }
  }
}

/// What is refused leaves no trace: the next scans get the labels they would have had.
TEST(Pipeline, RefusedScanLeavesThePipelineAsItWas) {
  const SmallWorld world = small_world({.seed = 7});
  const auto expected = labels_of(world, easily_moving(), Variant::kPaper2024, 2);
  ASSERT_GT(moving_points(expected), 0U);
  std::vector<Point> overflowing = world.scans[0];
  overflowing[100].x = 1e8F;
  overflowing[300].x = 1e8F;
  Pose not_a_number = Pose::Identity();
  not_a_number.translation().x() = std::nan("");
  Pipeline pipeline(easily_moving(), {2});
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    EXPECT_THROW(pipeline.push(world.scans[k], not_a_number), std::range_error);
    try {
      pipeline.push(overflowing, world.poses[k]);
      FAIL() << "no error";
    } catch (const std::range_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("point 100"));
    }
    const std::vector<LabelledScan> results = pipeline.push(world.scans[k], world.poses[k]);
    EXPECT_EQ(results[0].labels, expected[k]);
    EXPECT_EQ(results[0].scan_index, k);
  }
}

TEST(Pipeline, ReportsNonfinitePointsAndTheThreshold) {
  SmallWorld world = small_world({.seed = 8});
  world.scans[9][4].y = std::numeric_limits<float>::infinity();
  world.scans[9][5].z = std::numeric_limits<float>::quiet_NaN();
  Pipeline pipeline(easily_moving());
  std::size_t with_threshold = 0;
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    const LabelledScan result = pipeline.push(world.scans[k], world.poses[k])[0];
    EXPECT_EQ(result.nonfinite_points, k == 9 ? 2U : 0U);
    with_threshold += result.threshold.has_value();
    EXPECT_TRUE(k > 3 || !result.threshold) << "the window is not full";
    // No point moves without a threshold above the minimum.
    EXPECT_TRUE(moving_points({result.labels}) == 0 || result.threshold.value_or(0) > 1.0);
  }
  EXPECT_GT(with_threshold, 5U);
}

TEST(Pipeline, TimesEveryStageInItsOrder) {
  const SmallWorld world = small_world({.seed = 9});
  for (const bool cpu_times : {false, true}) {
    Pipeline pipeline(easily_moving(), {.cpu_times = cpu_times});
    double cpu_ms = 0;
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      const LabelledScan result = pipeline.push(world.scans[k], world.poses[k])[0];
      std::vector<std::string_view> names;
      for (std::size_t i = 0; i < result.stages.size(); ++i) {
        const StageTime& stage = result.stages[i];
        names.push_back(stage.name);
        EXPECT_GT(stage.wall_ms, 0.0);
        cpu_ms += stage.cpu_ms;
        if (i > 0) {
          EXPECT_GE(stage.start, result.stages[i - 1].start);
        }
      }
      std::vector<std::string_view> expected = {"voxelize", "raycast", "map_update", "evict"};
      if (k > 3) {
        expected.insert(expected.end(),
                        {"convolution", "median", "window", "otsu", "dynamic_region", "labels"});
      }
      EXPECT_EQ(names, expected) << k;
    }
    EXPECT_EQ(cpu_ms > 0, cpu_times);
  }
}

std::vector<std::size_t> judged(int delay_scans, int local_window_scans, std::size_t scan_count) {
  Config config = easily_moving(delay_scans);
  config.local_window_scans = local_window_scans;
  const SmallWorld world = small_world({.seed = 9, .scans = scan_count});
  Pipeline pipeline(config, {1, scan_count});
  std::vector<std::size_t> scans;
  for (const LabelledScan& result : results_of(pipeline, world)) {
    if (result.judged) scans.push_back(result.scan_index);
  }
  return scans;
}

// Worked by hand.
TEST(Pipeline, JudgesTheScansThatTheAuthorsProgramJudges) {
  EXPECT_EQ(judged(0, 3, 7), (std::vector<std::size_t>{4, 5, 6}));
  // Scan 0 never, scan N - n = 6 static, the others by the delayed detection or their own.
  EXPECT_EQ(judged(4, 3, 10), (std::vector<std::size_t>{1, 2, 3, 4, 5, 7, 8, 9}));
  // Delay 1 reaches back to scan 3 at k = 4 only.
  EXPECT_EQ(judged(1, 3, 7), (std::vector<std::size_t>{3, 4, 5}));
  EXPECT_EQ(judged(10, 3, 6), (std::vector<std::size_t>{}));
}

TEST(Pipeline, RefusesPosesThatAreNotRigid) {
  Pipeline pipeline(easily_moving());
  const std::vector<Point> points = {{2, 0, 0, 0}};
  Pose scaled = Pose::Identity();
  scaled.linear() *= 3;
  Pose mirrored = Pose::Identity();
  mirrored.linear()(2, 2) = -1;
  Pose nowhere = Pose::Identity();
  nowhere.translation().x() = std::nan("");
  for (const Pose& pose : {scaled, mirrored, nowhere}) {
    EXPECT_THROW(pipeline.push(points, pose), std::range_error);
    EXPECT_THROW((void)pipeline.observe(points, pose), std::range_error);
  }
  EXPECT_EQ(pipeline.push(points, Pose::Identity()).size(), 1U) << "goes on after a refusal";
}

/// One voxel on the way to a wall is free until scan 6, then occupied. With a kernel of one voxel
/// its change is one vote in scan 6, which a window of two scans holds in scans 6 and 7.
TEST(Pipeline, ScoresOfAPointAreTheVotesInTheWindowOfItsVoxel) {
  Config config = easily_moving();
  config.kernel_width_voxels = 1;
  config.local_window_scans = 2;
  const Point wall{4.1F, 0.1F, 0.1F, 0}, arrived{2.1F, 0.1F, 0.1F, 0}, near{0.1F, 0.1F, 0.1F, 0};
  Pipeline pipeline(config, {.scores = true});
  std::vector<std::vector<float>> scores;
  for (int k = 0; k < 9; ++k) {
    std::vector<Point> points = {wall, near};
    if (k >= 6) points.push_back(arrived);
    scores.push_back(pipeline.push(points, Pose::Identity()).front().scores);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(scores[k], (std::vector<float>{0, 0})) << k;
  }
  EXPECT_EQ(scores[6], (std::vector<float>{0, 0, 1}));
  EXPECT_EQ(scores[7], (std::vector<float>{0, 0, 1}));
  EXPECT_EQ(scores[8], (std::vector<float>{0, 0, 0}));
}

TEST(Pipeline, ScoresAreOnlyThereWhenAskedForAndChangeNoLabel) {
  const SmallWorld world = small_world({.seed = 10});
  for (const int delay : {0, 3}) {
    Pipeline with(easily_moving(delay), {1, world.scans.size(), true});
    Pipeline without(easily_moving(delay), {1, world.scans.size()});
    const std::vector<LabelledScan> scored = results_of(with, world);
    const std::vector<LabelledScan> plain = results_of(without, world);
    std::size_t above = 0, moving = 0;
    for (std::size_t k = 0; k < scored.size(); ++k) {
      EXPECT_EQ(scored[k].labels, plain[k].labels);
      EXPECT_TRUE(plain[k].scores.empty());
      ASSERT_EQ(scored[k].scores.size(), world.scans[k].size());
      moving += moving_points({plain[k].labels});
      if (!scored[k].threshold || *scored[k].threshold <= 1.0) continue;
      // Voxels above the threshold are dynamic.
      for (std::size_t i = 0; i < scored[k].scores.size(); ++i) {
        if (scored[k].scores[i] <= *scored[k].threshold) continue;
        EXPECT_EQ(scored[k].labels[i], kMovingLabel);
        ++above;
      }
    }
    EXPECT_GT(above, 20U);
    EXPECT_GT(moving, above);
  }
}

TEST(Pipeline, HoldsNothingBeforeTheFirstScan) {
  Pipeline pipeline(easily_moving());
  EXPECT_EQ(pipeline.memory()->map_blocks, 0U);
  EXPECT_EQ(pipeline.memory()->bytes, 0U);
  EXPECT_TRUE(pipeline.finish().empty());
}

TEST(Pipeline, CountsTheScansItHoldsAmongItsMemory) {
  const std::vector<Point> many(10'000, Point{2, 1, 0, 0});
  Pipeline online(easily_moving());
  Pipeline delayed(easily_moving(8));
  for (int k = 0; k < 8; ++k) {
    online.push(many, Pose::Identity());
    delayed.push(many, Pose::Identity());
  }
  // A voxel number for each point of eight scans; labels come when they are final.
  EXPECT_GE(delayed.memory()->bytes, online.memory()->bytes + 8 * 10'000 * 4);
}

}  // namespace
}  // namespace mosbench
