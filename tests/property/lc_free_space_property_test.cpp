#include <gtest/gtest.h>

#include <algorithm>

#include "core/methods/lc_free_space/pipeline.hpp"
#include "tests/small_world.hpp"

namespace mosbench {
namespace {

SmallWorldOptions lc_world_options(unsigned seed) {
  // More points than one chunk holds.
  return {.seed = seed,
          .azimuths = 300,
          .elevations = 40,
          .noise_m = 0.01,
          .jitter_rad = 0.002,
          .defects = seed % 2 == 0};
}

lc_free_space::Config lc_config_of_rays(const SmallWorldOptions& options) {
  lc_free_space::Config config;
  config.voxel_size_m = 0.25;
  config.min_range_m = 0.3;
  config.max_range_m = 5.0;
  config.range_image_rows = options.elevations;
  config.range_image_columns = options.azimuths;
  config.field_of_view_down_deg = -42;
  config.field_of_view_up_deg = 42;
  return config;
}

std::vector<LabelledScan> lc_results(const SmallWorld& world, const lc_free_space::Config& config,
                                     unsigned threads = 1) {
  lc_free_space::Pipeline pipeline(config, {.threads = threads, .scores = true});
  return results_of(pipeline, world);
}

TEST(LcFreeSpaceThreads, ChangeNoLabelAndNoScore) {
  std::size_t moving = 0;
  for (unsigned seed = 80; seed < 83; ++seed) {
    const SmallWorld world = small_world(lc_world_options(seed));
    const lc_free_space::Config config = lc_config_of_rays(lc_world_options(seed));
    const auto expected = lc_results(world, config);
    for (const unsigned threads : {2U, 7U}) {
      const auto results = lc_results(world, config, threads);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(results[k].labels, expected[k].labels) << "scan " << k;
        ASSERT_EQ(results[k].scores, expected[k].scores) << "scan " << k;
        moving += static_cast<std::size_t>(std::ranges::count(results[k].labels, kMovingLabel));
      }
    }
  }
  EXPECT_GT(moving, 5000U);
}

/// Points whose score is above the threshold move; by cluster more do, never fewer.
TEST(LcFreeSpaceScores, TellWhichPointsMoveByTheirOwnVoxel) {
  std::size_t by_point = 0, by_cluster = 0;
  for (const double free_above_voxels : {0.5, 1.0, 1.5}) {
    const SmallWorld world = small_world(lc_world_options(84));
    lc_free_space::Config config = lc_config_of_rays(lc_world_options(84));
    config.free_above_voxels = free_above_voxels;
    const auto clusters = lc_results(world, config);
    config.level = lc_free_space::Level::kPoint;
    const auto points = lc_results(world, config);
    for (std::size_t k = 0; k < points.size(); ++k) {
      ASSERT_EQ(points[k].threshold, config.free_above_m());
      ASSERT_EQ(points[k].scores, clusters[k].scores);
      for (std::size_t i = 0; i < points[k].labels.size(); ++i) {
        const bool moves = points[k].labels[i] == kMovingLabel;
        const bool with_neighbours = clusters[k].labels[i] == kMovingLabel;
        ASSERT_EQ(moves, points[k].scores[i] > config.free_above_m());
        ASSERT_TRUE(with_neighbours || !moves);
        by_point += moves;
        by_cluster += with_neighbours;
      }
    }
  }
  EXPECT_GT(by_point, 3000U);
  EXPECT_GT(by_cluster, by_point);
}

TEST(LcFreeSpaceMemory, StaysBoundedWhileTheSensorTravels) {
  const SmallWorldOptions options{.seed = 61, .scans = 10, .azimuths = 60, .elevations = 20};
  const SmallWorld world = small_world(options);
  lc_free_space::Pipeline pipeline(lc_config_of_rays(options));
  std::size_t early_bytes = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    Pose pose = world.poses[k % 10];
    pose.translation().x() += 0.5 * static_cast<double>(k);
    pipeline.push(world.scans[k % 10], pose);
    if (k == 60) early_bytes = pipeline.memory()->bytes;
  }
  ASSERT_GT(early_bytes, 100'000U);
  EXPECT_LT(pipeline.memory()->bytes, early_bytes + early_bytes / 2);
}

}  // namespace
}  // namespace mosbench
