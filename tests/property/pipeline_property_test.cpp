#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/methods/hmm_mos/pipeline.hpp"
#include "tests/small_world.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

constexpr Variant kVariants[] = {Variant::kPaper2024, Variant::kRelease2025};

Config finer_config() {
  Config config = small_world_config();
  config.voxel_size_m = 0.25;
  config.min_otsu_score = 1;
  return config;
}

TEST(StaticWorld, HasNoMovingPointForAStaticNoiselessSensor) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const SmallWorld world = small_world(
        {.seed = seed, .scans = 25, .moving_boxes = 0, .jitter_rad = 0.0, .walk_m = 0.0});
    for (const Variant variant : kVariants) {
      EXPECT_EQ(moving_points(labels_of(world, finer_config(), variant)), 0U);
    }
    Config delayed = finer_config();
    delayed.delay_scans = 4;
    EXPECT_EQ(moving_points(labels_of(world, delayed, Variant::kPaper2024, 1, 25)), 0U);
  }
}

/// All numbers are multiples of 2^-10 and below 2^13, so that sums and voxel corners are exact.
SmallWorld on_a_lattice(SmallWorld world) {
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    world.poses[k].linear().setIdentity();
    for (int axis = 0; axis < 3; ++axis) {
      double& t = world.poses[k].translation()[axis];
      t = std::round(t * 1024) / 1024;
    }
    for (Point& p : world.scans[k]) {
      p = {std::round(p.x * 1024) / 1024, std::round(p.y * 1024) / 1024,
           std::round(p.z * 1024) / 1024, 0.0F};
    }
  }
  return world;
}

TEST(WholeVoxelTranslation, ChangesNoLabel) {
  std::size_t moving = 0;
  for (unsigned seed = 10; seed < 16; ++seed) {
    SmallWorld world = on_a_lattice(small_world({.seed = seed}));
    for (const Variant variant : kVariants) {
      const auto expected = labels_of(world, finer_config(), variant);
      moving += moving_points(expected);
      // Whole blocks of eight voxels, odd numbers of voxels, across the origin.
      for (const Eigen::Vector3d& voxels :
           {Eigen::Vector3d{8, 16, -24}, Eigen::Vector3d{8000, -8000, 800},
            Eigen::Vector3d{1, -3, 5}, Eigen::Vector3d{-1001, 7, -13}}) {
        SmallWorld moved = world;
        for (Pose& pose : moved.poses) pose.translation() += voxels * 0.25;
        ASSERT_EQ(labels_of(moved, finer_config(), variant), expected);
      }
    }
  }
  EXPECT_GT(moving, 500U);
}

TEST(PointOrder, PermutesLabelsAndChangesNoneOfThem) {
  std::size_t moving = 0;
  for (unsigned seed = 20; seed < 24; ++seed) {
    SmallWorld world = small_world({.seed = seed, .defects = seed % 2 == 0});
    SmallWorld shuffled = world;
    std::mt19937 random(seed);
    std::vector<std::vector<std::size_t>> orders;
    for (std::vector<Point>& scan : shuffled.scans) {
      std::vector<std::size_t>& order = orders.emplace_back(scan.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::shuffle(order.begin(), order.end(), random);
      const std::vector<Point> original = scan;
      for (std::size_t i = 0; i < order.size(); ++i) scan[i] = original[order[i]];
    }
    for (const Variant variant : kVariants) {
      const auto expected = labels_of(world, finer_config(), variant);
      const auto labels = labels_of(shuffled, finer_config(), variant, 3);
      moving += moving_points(expected);
      for (std::size_t k = 0; k < labels.size(); ++k) {
        for (std::size_t i = 0; i < labels[k].size(); ++i) {
          ASSERT_EQ(labels[k][i], expected[k][orders[k][i]]) << "scan " << k;
        }
      }
    }
  }
  EXPECT_GT(moving, 300U);
}

TEST(RepeatedPoints, ChangeNoLabel) {
  std::size_t moving = 0;
  for (unsigned seed = 25; seed < 29; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    SmallWorld doubled = world;
    for (std::vector<Point>& scan : doubled.scans) {
      const std::vector<Point> once = scan;
      scan.insert(scan.end(), once.begin(), once.end());
    }
    const auto expected = labels_of(world, finer_config(), Variant::kPaper2024);
    const auto labels = labels_of(doubled, finer_config(), Variant::kPaper2024);
    moving += moving_points(expected);
    for (std::size_t k = 0; k < labels.size(); ++k) {
      auto twice = expected[k];
      twice.insert(twice.end(), expected[k].begin(), expected[k].end());
      ASSERT_EQ(labels[k], twice);
    }
  }
  EXPECT_GT(moving, 300U);
}

TEST(ThreadCountAndRepetition, ChangeNothing) {
  std::size_t moving = 0;
  for (unsigned seed = 30; seed < 34; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .azimuths = 60, .elevations = 30});
    for (const Variant variant : kVariants) {
      const auto expected = labels_of(world, finer_config(), variant, 1);
      moving += moving_points(expected);
      for (const unsigned threads : {1U, 2U, 7U}) {
        ASSERT_EQ(labels_of(world, finer_config(), variant, threads), expected);
      }
    }
  }
  EXPECT_GT(moving, 1000U);
}

TEST(Labels, AreStaticOrMovingForEveryPointOfEveryScan) {
  const SmallWorld world = small_world({.seed = 40, .scans = 30, .defects = true});
  const auto labels = labels_of(world, finer_config(), Variant::kPaper2024);
  ASSERT_EQ(labels.size(), world.scans.size());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    ASSERT_EQ(labels[k].size(), world.scans[k].size());
    for (const std::uint32_t label : labels[k]) {
      ASSERT_TRUE(label == kStaticLabel || label == kMovingLabel);
    }
  }
}

/// A sensor that goes on for ever past walls that repeat: what lies behind has to be given back.
TEST(Memory, StaysBoundedOverTwoThousandScans) {
  for (const Variant variant : kVariants) {
    Config config = finer_config();
    config.voxel_size_m = 0.4;
    config.max_range_m = 2.5;
    config.global_window_scans = 60;
    config.dynamic_window_scans = 40;
    config.delay_scans = variant == Variant::kPaper2024 ? 5 : 0;
    const SmallWorld world = small_world({.seed = 50,
                                          .scans = 100,
                                          .azimuths = 16,
                                          .elevations = 6,
                                          .moving_boxes = 3,
                                          .walk_m = 0.0});
    Pipeline pipeline(of_variant(config, variant));
    std::size_t blocks_early = 0, blocks_late = 0, bytes_early = 0, bytes_late = 0;
    for (std::size_t k = 0; k < 2000; ++k) {
      Pose pose = world.poses[k % 100];
      pose.translation().x() += 0.08 * static_cast<double>(k);
      pipeline.push(world.scans[k % 100], pose);
      std::size_t& blocks = k < 400 ? blocks_early : blocks_late;
      std::size_t& bytes = k < 400 ? bytes_early : bytes_late;
      blocks = std::max(blocks, pipeline.memory()->map_blocks);
      bytes = std::max(bytes, pipeline.memory()->bytes);
    }
    EXPECT_GT(blocks_early, 8U);
    EXPECT_LE(blocks_late, blocks_early + blocks_early / 4);
    EXPECT_LE(bytes_late, bytes_early + bytes_early / 4);
    // Once nothing is seen for longer than w_g, the map is empty again.
    for (std::size_t k = 0; k < 100; ++k) pipeline.push({}, world.poses[0]);
    EXPECT_EQ(pipeline.memory()->map_blocks, 0U);
  }
}

}  // namespace
}  // namespace mosbench
