#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/methods/lc_free_space/pipeline.hpp"
#include "core/tsdf/integration.hpp"
#include "core/tsdf/tsdf_map.hpp"

/// Numbers worked by hand.
namespace mosbench::lc_free_space {
namespace {

TEST(LcFreeSpaceConfig, DefaultsAreLegalAndOneVoxelIsFree) {
  const Config config;
  EXPECT_NO_THROW(check(config));
  EXPECT_EQ(config.free_above_m(), 0.2F);
  EXPECT_EQ(config.least_free_m(), std::nextafter(0.2F, 1.0F));
  EXPECT_EQ(config.truncation_m(), 0.4F);
}

TEST(LcFreeSpaceConfig, RefusesValuesThatDoNotGoTogether) {
  const auto refuses = [](auto&& change) {
    Config config;
    change(config);
    EXPECT_THROW(check(config), std::invalid_argument);
  };
  refuses([](Config& c) { c.min_range_m = 30; });
  refuses([](Config& c) { c.voxel_size_m = 0.01; });
  refuses([](Config& c) { c.range_image_rows = 1; });
  refuses([](Config& c) { c.free_above_voxels = 2; });
  refuses([](Config& c) { c.free_above_voxels = -1; });
}

/// Measured voxels.
VoxelSet set_of(const std::vector<Voxel>& voxels) {
  VoxelSet set;
  for (const Voxel& v : voxels) set.masks[set.insert(block_of(v))].set(cell_of(v));
  return set;
}

bool holds(const VoxelSet& measured, const std::vector<BlockMask>& masks, const Voxel& voxel) {
  return masks[measured.find(block_of(voxel))].test(cell_of(voxel));
}

/// Returns whether a voxel of 0.25 m, 5 m before the sensor, is free after it saw this depth once.
bool is_free_before(float depth_m) {
  Config config;
  config.voxel_size_m = 0.25;
  const tsdf::SensorModel sensor{.rows = 64, .columns = 2048, .down_deg = -20, .up_deg = 20};
  tsdf::RangeImage image{.rows = 64, .columns = 2048, .ranges_m = {}};
  image.ranges_m.assign(65 * 2048, depth_m);
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(10.125, 0.125, 0.125);
  const Voxel voxel{20, 0, 0};  // its centre is 5 m along -x of the sensor
  tsdf::TsdfMap map(config.least_free_m());
  ThreadPool pool(1);
  const auto touched = map.touch({tsdf::wide_of(block_of(voxel))});
  const VoxelGrid grid{.voxel_size_m = 0.25};
  tsdf::integrate(map, touched.slots, grid, {image, sensor, pose}, config, pool);
  const tsdf::MapBlock* block = map.find(block_of(voxel));
  EXPECT_EQ(map.distance_m(block, cell_of(voxel)), depth_m - 5.0F);
  const VoxelSet measured = set_of({voxel});
  return holds(measured, in_free_space(measured, map), voxel);
}

TEST(LcFreeSpace, BeginsBeyondTheThresholdNotAtIt) {
  EXPECT_FALSE(is_free_before(5.25F)) << "d is the threshold";
  EXPECT_TRUE(is_free_before(std::nextafter(5.25F, 6.0F)));
  EXPECT_FALSE(is_free_before(std::nextafter(5.25F, 5.0F)));
}

TEST(LcFreeSpace, IsNowhereThatWasNotObserved) {
  tsdf::TsdfMap map(Config{}.least_free_m());
  const VoxelSet measured = set_of({{1, 1, 1}, {100, 0, 0}});
  map.touch({{0, 0, 0}});
  for (const BlockMask& mask : in_free_space(measured, map)) EXPECT_FALSE(mask.any());
}

TEST(LcFreeSpaceGrowth, TakesVoxelsThatShareAFaceAndNoneBeyondThem) {
  for (const Voxel& seed : {Voxel{0, 0, 0}, Voxel{7, 7, 7}, Voxel{3, 4, 5}, Voxel{-1, -8, 8}}) {
    std::vector<Voxel> all;
    for (int i = 0; i < 125; ++i) {
      all.push_back({seed.x + i % 5 - 2, seed.y + i / 5 % 5 - 2, seed.z + i / 25 - 2});
    }
    const VoxelSet measured = set_of(all);
    std::vector<BlockMask> seeds(measured.block_count());
    seeds[measured.find(block_of(seed))].set(cell_of(seed));
    const std::vector<BlockMask> around = grown(measured, seeds);
    std::size_t count = 0;
    for (const Voxel& v : all) {
      const int steps = std::abs(v.x - seed.x) + std::abs(v.y - seed.y) + std::abs(v.z - seed.z);
      EXPECT_EQ(holds(measured, around, v), steps <= 1);
      count += holds(measured, around, v);
    }
    EXPECT_EQ(count, 7U);
  }
}

TEST(LcFreeSpaceGrowth, TakesOnlyVoxelsWithPoints) {
  const VoxelSet measured = set_of({{7, 0, 0}, {9, 0, 0}});
  std::vector<BlockMask> seeds(measured.block_count());
  seeds[measured.find({0, 0, 0})].set(cell_of({7, 0, 0}));
  const std::vector<BlockMask> around = grown(measured, seeds);
  EXPECT_EQ(around[0].count() + around[1].count(), 1U);
}

/// A sphere of returns around the sensor, 15.05 m away, with a point at `object_m` on -x.
std::vector<Point> sphere_and_object(float object_m) {
  std::vector<Point> points;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 512; ++column) {
      const double e = (32.0 - 64.0 * (row + 0.5) / 64) / 180 * std::numbers::pi;
      const double a = (column + 0.5) / 512 * 2 * std::numbers::pi;
      points.push_back({static_cast<float>(15.05 * std::cos(e) * std::cos(a)),
                        static_cast<float>(-15.05 * std::cos(e) * std::sin(a)),
                        static_cast<float>(15.05 * std::sin(e)), 0});
    }
  }
  points.push_back({-15.05F, 0, 0, 0});  // in the voxel of the wall whose centre is 15 m away
  if (object_m > 0) points.push_back({-object_m, 0, 0, 0});
  return points;
}

/// Labels of the wall's point on -x and of the object, in the scan after `scans` without it.
std::pair<bool, bool> wall_and_object_move(Level level, float object_m, int scans) {
  Config config;
  config.level = level;
  config.range_image_rows = 64;
  config.range_image_columns = 512;
  config.field_of_view_down_deg = -32;
  config.field_of_view_up_deg = 32;
  Pipeline pipeline(config, {.scores = true});
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0.1, 0.1, 0.1);  // voxels' centres lie 0.2 m apart on -x
  for (int i = 0; i < scans; ++i) {
    const LabelledScan empty = std::move(pipeline.push(sphere_and_object(0), pose).front());
    EXPECT_EQ(std::ranges::count(empty.labels, kMovingLabel), 0);
  }
  const LabelledScan scan = std::move(pipeline.push(sphere_and_object(object_m), pose).front());
  EXPECT_NEAR(scan.scores.back(), scans == 0 ? 0 : std::min(0.4F, 15.05F - object_m), 2e-3);
  const auto moves = [&](std::size_t from_end) {
    return scan.labels[scan.labels.size() - from_end] == kMovingLabel;
  };
  return {moves(2), moves(1)};
}

TEST(LcFreeSpacePipeline, CallsNothingMovingInItsFirstScan) {
  using Moves = std::pair<bool, bool>;
  EXPECT_EQ(wall_and_object_move(Level::kCluster, 10.0F, 0), Moves(false, false));
  EXPECT_EQ(wall_and_object_move(Level::kCluster, 10.0F, 1), Moves(false, true))
      << "one scan is enough: there is no burn-in";
}

TEST(LcFreeSpacePipeline, TakesAPointOfASurfaceBesideAFreeOneWithItByClusterAlone) {
  using Moves = std::pair<bool, bool>;
  EXPECT_EQ(wall_and_object_move(Level::kPoint, 14.8F, 3), Moves(false, true));
  EXPECT_EQ(wall_and_object_move(Level::kCluster, 14.8F, 3), Moves(true, true));
  EXPECT_EQ(wall_and_object_move(Level::kCluster, 14.6F, 3), Moves(false, true))
      << "the voxel between them has no point";
}

}  // namespace
}  // namespace mosbench::lc_free_space
