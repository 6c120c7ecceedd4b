#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/methods/dynablox/pipeline.hpp"
#include "tests/small_world.hpp"

namespace mosbench {
namespace {

dynablox::Config dynablox_of_rays(const SmallWorldOptions& options) {
  dynablox::Config config;
  config.voxel_size_m = 0.25;
  config.min_range_m = 0.3;
  config.max_range_m = 5.0;
  config.range_image_rows = options.elevations;
  config.range_image_columns = options.azimuths;
  config.field_of_view_down_deg = -42;
  config.field_of_view_up_deg = 42;
  config.box_test = dynablox::BoxTest::kFixed;  // the authors' depends on where the map begins
  config.min_cluster_points = 5;
  return config;
}

std::vector<LabelledScan> dynablox_results(const SmallWorld& world, const dynablox::Config& config,
                                           unsigned threads = 1) {
  dynablox::Pipeline pipeline(config, {.threads = threads, .scores = true});
  return results_of(pipeline, world);
}

std::size_t moving_in(const std::vector<LabelledScan>& results) {
  std::size_t moving = 0;
  for (const LabelledScan& scan : results) {
    moving += static_cast<std::size_t>(std::ranges::count(scan.labels, kMovingLabel));
  }
  return moving;
}

void expect_equal(const std::vector<LabelledScan>& some, const std::vector<LabelledScan>& others) {
  ASSERT_EQ(some.size(), others.size());
  for (std::size_t k = 0; k < some.size(); ++k) {
    ASSERT_EQ(some[k].labels, others[k].labels) << "scan " << k;
    ASSERT_EQ(some[k].scores, others[k].scores) << "scan " << k;
    ASSERT_EQ(some[k].objects, others[k].objects) << "scan " << k;
  }
}

TEST(DynabloxThreads, ChangeNoLabelScoreOrObject) {
  std::size_t moving = 0;
  for (unsigned seed = 20; seed < 24; ++seed) {
    // More points than one chunk holds.
    const SmallWorldOptions options{.seed = seed,
                                    .azimuths = 300,
                                    .elevations = 40,
                                    .noise_m = 0.01,
                                    .jitter_rad = 0.002,
                                    .defects = seed % 2 == 0};
    const SmallWorld world = small_world(options);
    const auto expected = dynablox_results(world, dynablox_of_rays(options));
    moving += moving_in(expected);
    for (const unsigned threads : {2U, 7U}) {
      expect_equal(dynablox_results(world, dynablox_of_rays(options), threads), expected);
    }
  }
  EXPECT_GT(moving, 5000U);
}

/// A scan may be observed while another thread pushes the one before.
TEST(DynabloxObserved, AheadGivesTheSameLabels) {
  const SmallWorldOptions options{.seed = 26, .azimuths = 60, .elevations = 20};
  const SmallWorld world = small_world(options);
  const auto expected = dynablox_results(world, dynablox_of_rays(options));
  ASSERT_GT(moving_in(expected), 100U);
  dynablox::Pipeline pipeline(dynablox_of_rays(options), {.scores = true});
  std::vector<LabelledScan> results;
  auto next = pipeline.observe(world.scans[0], world.poses[0]);
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    auto current = std::move(next);
    if (k + 1 < world.scans.size()) next = pipeline.observe(world.scans[k + 1], world.poses[k + 1]);
    results.push_back(std::move(pipeline.push(std::move(current)).front()));
  }
  expect_equal(results, expected);
}

TEST(DynabloxInAStaticWorld, HasNoMovingPointForAStaticNoiselessSensor) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const SmallWorldOptions options{
        .seed = seed, .scans = 25, .moving_boxes = 0, .jitter_rad = 0.0, .walk_m = 0.0};
    EXPECT_EQ(moving_in(dynablox_results(small_world(options), dynablox_of_rays(options))), 0U);
  }
}

/// Poses and points are multiples of 2^-10, so that sums and voxel corners are exact.
TEST(DynabloxShiftedByWholeWideBlocks, ChangesNoLabel) {
  std::size_t moving = 0;
  for (unsigned seed = 30; seed < 33; ++seed) {
    const SmallWorldOptions options{.seed = seed, .azimuths = 60, .elevations = 20};
    SmallWorld world = small_world(options);
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      for (double& t : world.poses[k].translation()) t = std::round(t * 1024) / 1024;
      for (double& r : world.poses[k].linear().reshaped()) r = std::round(r * 4096) / 4096;
    }
    const auto expected = dynablox_results(world, dynablox_of_rays(options));
    moving += moving_in(expected);
    for (const Eigen::Vector3d& blocks :
         {Eigen::Vector3d{1, 2, -3}, Eigen::Vector3d{-512, 7, 13}}) {
      SmallWorld shifted = world;
      for (Pose& pose : shifted.poses) pose.translation() += blocks * 16 * 0.25;
      expect_equal(dynablox_results(shifted, dynablox_of_rays(options)), expected);
    }
  }
  EXPECT_GT(moving, 300U);
}

TEST(DynabloxObjects, KeepTheirNumbersAndCoverTheMovingPoints) {
  const SmallWorldOptions options{.seed = 41, .scans = 30, .azimuths = 120, .elevations = 30};
  std::set<std::uint32_t> before;
  std::size_t kept = 0, moving = 0;
  for (const LabelledScan& scan :
       dynablox_results(small_world(options), dynablox_of_rays(options))) {
    std::set<std::uint32_t> now;
    for (std::size_t i = 0; i < scan.labels.size(); ++i) {
      ASSERT_EQ(scan.objects[i] != 0, scan.labels[i] == kMovingLabel);
      if (scan.objects[i] == 0) continue;
      now.insert(scan.objects[i]);
      ++moving;
    }
    kept += static_cast<std::size_t>(
        std::ranges::count_if(now, [&](std::uint32_t number) { return before.contains(number); }));
    before = now;
  }
  EXPECT_GT(moving, 1000U);
  EXPECT_GT(kept, 10U);
}

TEST(DynabloxMemory, StaysBoundedWhileTheSensorTravels) {
  const SmallWorldOptions options{.seed = 60, .scans = 10, .azimuths = 60, .elevations = 20};
  const SmallWorld world = small_world(options);
  dynablox::Pipeline pipeline(dynablox_of_rays(options));
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
