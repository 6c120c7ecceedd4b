#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "core/methods/dynablox/clusters.hpp"
#include "core/methods/dynablox/ever_free.hpp"
#include "core/methods/dynablox/pipeline.hpp"

/// Numbers worked by hand from the published settings.
namespace mosbench::dynablox {
namespace {

TEST(DynabloxConfig, DefaultsAreTheAuthorsAndLegal) {
  const Config config;
  EXPECT_NO_THROW(check(config));
  EXPECT_EQ(config.truncation_m(), 0.4F);
  EXPECT_EQ(config.occupied_below_m(), 0.3F);
  EXPECT_TRUE(config.measures_sensor());
}

TEST(DynabloxConfig, RefusesValuesThatDoNotGoTogether) {
  const auto refuses = [](auto&& change) {
    Config config;
    change(config);
    EXPECT_THROW(check(config), std::invalid_argument);
  };
  refuses([](Config& c) { c.min_range_m = 30; });
  refuses([](Config& c) { c.voxel_size_m = 0.01; });
  refuses([](Config& c) { c.range_image_rows = 1; });
  refuses([](Config& c) { c.range_image_columns = 3; });
  refuses([](Config& c) { c.field_of_view_down_deg = 10; });
  refuses([](Config& c) { c.field_of_view_down_deg = c.field_of_view_up_deg = 5; });
  refuses([](Config& c) { c.occupied_below_voxels = 3; });
  refuses([](Config& c) { c.burn_in_scans = 0; });
  refuses([](Config& c) { c.truncation_voxels = 1; });
}

/// Two wide blocks in which everything was seen free and is ever-free.
EverFreeMap free_map(const Config& config) {
  EverFreeMap map(config.occupied_below_m());
  map.touch({{0, 0, 0}, {1, 0, 0}}, 0);
  for (const std::uint32_t slot : map.touched) {
    tsdf::MapBlock& block = map.tsdf.blocks[slot];
    map.tsdf.add_numbers(block);
    map.tsdf.numbers[block.numbers].distances_m.fill(0.4F);
    map.tsdf.numbers[block.numbers].weights.fill(1);
    block.near_surface = BlockMask{};
    block.observed = map.histories[slot].ever_free = ~BlockMask{};
  }
  map.add_voxels(config.counter_to_reset_scans);
  return map;
}

std::size_t cleared_voxels(const EverFreeMap& map) {
  std::size_t cleared = 0;
  for (const std::uint32_t slot : map.touched) {
    cleared += (~map.histories[slot].ever_free).count();
  }
  return cleared;
}

TEST(DynabloxEverFree, EndsWithItsNeighboursAfterSoManyOccupiedFrames) {
  const Config config;
  ThreadPool pool(1);
  const Voxel voxel{15, 7, 7};  // its neighbours lie in four blocks of either wide block
  VoxelSet points;
  points.masks[points.insert(block_of(voxel))].set(cell_of(voxel));
  EverFreeMap map = free_map(config);
  for (std::int32_t frame = 1000; frame < 1149; ++frame) {
    update_ever_free(map, points, frame, config, pool);
    ASSERT_EQ(cleared_voxels(map), 0U);
  }
  update_ever_free(map, points, 1149, config, pool);
  EXPECT_EQ(cleared_voxels(map), 27U);
  EXPECT_FALSE(map.ever_free_in({2, 0, 0}).test(cell_of({16, 7, 7})));
}

TEST(DynabloxEverFree, CountsOnOverGapsWithinTheBufferAlone) {
  const Config config;
  ThreadPool pool(1);
  const Voxel voxel{4, 4, 4};
  VoxelSet points;
  points.masks[points.insert(block_of(voxel))].set(cell_of(voxel));
  for (const int gap : {2, 3}) {
    EverFreeMap map = free_map(config);
    std::int32_t frame = 1000;
    for (int i = 0; i < 149; ++i, ++frame) update_ever_free(map, points, frame, config, pool);
    for (int i = 1; i < gap; ++i, ++frame) update_ever_free(map, {}, frame, config, pool);
    update_ever_free(map, points, frame, config, pool);
    EXPECT_EQ(cleared_voxels(map), gap == 2 ? 27U : 0U);
  }
}

TEST(DynabloxEverFree, OneThatAnEarlierOneClearedClearsNoneItself) {
  Config config;
  config.counter_to_reset_scans = 1;
  ThreadPool pool(1);
  VoxelSet points;
  points.masks[points.insert({0, 0, 0})].set(cell_of({3, 4, 4}));
  points.masks[points.insert({0, 0, 0})].set(cell_of({4, 4, 4}));
  EverFreeMap map = free_map(config);
  update_ever_free(map, points, 1000, config, pool);
  EXPECT_EQ(cleared_voxels(map), 27U);
}

/// A sphere of returns around the sensor, with an object of some points when asked.
std::vector<Point> sphere(int object_points) {
  std::vector<Point> points;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 512; ++column) {
      const double e = (32.0 - 64.0 * (row + 0.5) / 64) / 180 * std::numbers::pi;
      const double a = (column + 0.5) / 512 * 2 * std::numbers::pi;
      points.push_back({static_cast<float>(15 * std::cos(e) * std::cos(a)),
                        static_cast<float>(-15 * std::cos(e) * std::sin(a)),
                        static_cast<float>(15 * std::sin(e)), 0});
    }
  }
  for (int i = 0; i < object_points; ++i) {
    points.push_back({-3.1F + 0.2F * static_cast<float>(i % 3), 2.1F, 0.1F, 0});  // three voxels
  }
  return points;
}

Config sphere_config(Level level) {
  Config config;
  config.level = level;
  config.range_image_rows = 64;
  config.range_image_columns = 512;
  config.field_of_view_down_deg = -32;
  config.field_of_view_up_deg = 32;
  return config;
}

/// Moving points of an object that comes in frame `frame`, the sensor having moved far away before
/// frame `first` and stood since.
std::size_t moving_points(const Config& config, int first, int frame, int object_points) {
  Pipeline pipeline(config);
  Pose pose = Pose::Identity();
  for (int f = 1; f < frame; ++f) {
    pose.translation().x() = f < first ? -500 : 0;
    const std::vector<std::uint32_t> labels = pipeline.push(sphere(0), pose).front().labels;
    EXPECT_EQ(std::ranges::count(labels, kMovingLabel), 0);
  }
  pose.translation().x() = 0;
  const LabelledScan last = std::move(pipeline.push(sphere(object_points), pose).front());
  const std::size_t moving =
      static_cast<std::size_t>(std::ranges::count(last.labels, kMovingLabel));
  if (config.level == Level::kObject) {
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(last.objects, 1U)), moving);
  } else {
    EXPECT_TRUE(last.objects.empty());
  }
  return moving;
}

TEST(DynabloxPipeline, FindsWhatComesIntoSpaceThatWasFreeForTheBurnIn) {
  EXPECT_EQ(moving_points(sphere_config(Level::kPoint), 1, 5, 21), 0U);
  EXPECT_EQ(moving_points(sphere_config(Level::kPoint), 1, 6, 21), 21U);
}

TEST(DynabloxPipeline, HasNoBurnInForBlocksThatAreSeenFreeAtFirstSight) {
  EXPECT_EQ(moving_points(sphere_config(Level::kPoint), 10, 11, 21), 0U);
  EXPECT_EQ(moving_points(sphere_config(Level::kPoint), 10, 12, 21), 21U);
  Config waits = sphere_config(Level::kPoint);
  waits.initial_last_occupied = InitialLastOccupied::kNow;
  EXPECT_EQ(moving_points(waits, 10, 15, 21), 0U);
  EXPECT_EQ(moving_points(waits, 10, 16, 21), 21U);
}

TEST(DynabloxPipeline, CallsObjectsOfTwentyPointsMovingAndNoSmallerOnes) {
  EXPECT_EQ(moving_points(sphere_config(Level::kObject), 1, 6, 19), 0U);
  EXPECT_EQ(moving_points(sphere_config(Level::kPoint), 1, 6, 19), 19U);
  EXPECT_EQ(moving_points(sphere_config(Level::kObject), 1, 6, 20), 20U);
  Config tracked = sphere_config(Level::kObject);
  tracked.min_track_scans = 1;
  EXPECT_EQ(moving_points(tracked, 1, 6, 20), 0U) << "seen for the first time";
}

TEST(DynabloxBoxes, OverlapWithinTheMarginAsTheAuthorsTestItOrCorrected) {
  const VoxelBox a{{0, 0, 50}, {2, 2, 52}}, b{{4, 0, 50}, {6, 2, 52}};
  EXPECT_TRUE(overlap(a, b, 1.0, BoxTest::kFixed)) << "one voxel between them";
  EXPECT_FALSE(overlap(a, b, 0.9, BoxTest::kFixed));
  EXPECT_FALSE(overlap(a, b, 1.0, BoxTest::kAuthors)) << "lower z of a is above upper x of b";
  const VoxelBox low{{0, 0, 0}, {2, 2, 2}};
  EXPECT_TRUE(overlap(low, low, 0, BoxTest::kAuthors));
}

TEST(DynabloxTracks, JoinTheNearestPairsFirstAndGiveNoNumberTwice) {
  Tracks tracks(1.0);
  const auto numbers = [&](const std::vector<double>& along_x) {
    std::vector<Eigen::Vector3d> centres;
    for (const double x : along_x) centres.emplace_back(x, 0, 0);
    std::vector<std::uint32_t> result;
    for (const Tracks::Track& track : tracks.follow(centres)) result.push_back(track.number);
    return result;
  };
  using Numbers = std::vector<std::uint32_t>;
  EXPECT_EQ(numbers({0, 5}), (Numbers{1, 2}));
  EXPECT_EQ(numbers({5.5, 0.9, 0.2}), (Numbers{2, 3, 1}));
  EXPECT_EQ(numbers({0.2, 7}), (Numbers{1, 4})) << "too far from 5.5";
  EXPECT_EQ(numbers({}), Numbers{});
  EXPECT_EQ(numbers({0.2}), Numbers{5});
}

}  // namespace
}  // namespace mosbench::dynablox
