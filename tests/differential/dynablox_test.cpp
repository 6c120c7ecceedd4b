#include <gtest/gtest.h>

#include <random>

#include "core/methods/dynablox/pipeline.hpp"
#include "core/tsdf/range_image.hpp"
#include "tests/dynablox_twin.hpp"
#include "tests/small_world.hpp"

/// dynablox and its stages against slow twins.
namespace mosbench {
namespace {

dynablox::Config dynablox_of_a_room() {
  dynablox::Config config;
  config.voxel_size_m = 0.25;
  config.min_range_m = 0.3;
  config.max_range_m = 5.0;
  config.range_image_rows = 12;
  config.range_image_columns = 30;
  config.field_of_view_down_deg = -43;
  config.field_of_view_up_deg = 40;
  config.burn_in_scans = 3;
  config.counter_to_reset_scans = 6;
  config.min_cluster_points = 3;
  return config;
}

TEST(DynabloxTwin, GivesTheSameLabelsAndScores) {
  std::size_t moving = 0, ever_free = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    dynablox::Config config = dynablox_of_a_room();
    if (seed % 2 == 1) config.level = dynablox::Level::kPoint;
    if (seed % 3 == 1) config.initial_last_occupied = dynablox::InitialLastOccupied::kNow;
    if (seed % 4 == 2) config.box_test = dynablox::BoxTest::kFixed;
    if (seed % 4 == 3) config.missing_returns = dynablox::MissingReturns::kKeep;
    config.max_weight = seed < 4 ? 1000 : 20;
    const SmallWorld world =
        small_world({.seed = seed, .scans = 14, .noise_m = 0.02, .defects = seed > 5});
    dynablox_twin::DynabloxTwin twin(config);
    dynablox::Pipeline pipeline(config, {.threads = 1 + seed % 3, .scores = true});
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      const dynablox_twin::TwinResult expected = twin.push(world.scans[k], world.poses[k]);
      const LabelledScan result = std::move(pipeline.push(world.scans[k], world.poses[k]).front());
      ASSERT_EQ(result.labels, expected.labels) << "seed " << seed << ", scan " << k;
      ASSERT_EQ(result.scores, expected.scores) << "seed " << seed << ", scan " << k;
      moving += static_cast<std::size_t>(std::ranges::count(result.labels, kMovingLabel));
    }
    ever_free += twin.ever_free_voxels();
  }
  EXPECT_GT(moving, 300U);
  EXPECT_GT(ever_free, 1000U);
}

TEST(DynabloxClusters, AreThoseOfLoopsOverAllPairs) {
  std::mt19937 random(5);
  std::size_t merged = 0, found_clusters = 0;
  for (int round = 0; round < 200; ++round) {
    dynablox::Config config;
    config.voxel_size_m = 1;
    config.min_range_m = 0.5;
    config.min_cluster_points = 1 + round % 4;
    config.cluster_separation_voxels = std::array{0.0, 1.0, 1.5, 2.3}[random() % 4];
    config.box_test = static_cast<dynablox::BoxTest>(random() % 2);
    std::vector<Point> points;
    for (int i = 0; i < 120; ++i) {
      const auto coordinate = [&] { return static_cast<float>(random() % 9) - 3.5F; };
      points.push_back({coordinate() + 6, coordinate(), coordinate(), 0});
    }
    ThreadPool pool(1);
    const VoxelGrid grid = grid_around(Eigen::Vector3d::Zero(), 1);
    const VoxelizedScan scan = voxelize(points, Pose::Identity(), grid, 0.5, 20, pool);
    std::vector<BlockMask> seeds(scan.measured.block_count());
    std::set<dynablox_twin::Index> occupied, seed_set;
    for (std::size_t slot = 0; slot < seeds.size(); ++slot) {
      for_each_cell(scan.measured.masks[slot], [&](std::uint32_t cell) {
        const Voxel v = voxel_at(scan.measured.blocks[slot], cell);
        occupied.insert({v.z, v.y, v.x});
        if (random() % 4 != 0) return;
        seeds[slot].set(cell);
        seed_set.insert({v.z, v.y, v.x});
      });
    }
    std::vector<dynablox_twin::Index> in_order(seed_set.begin(), seed_set.end());
    std::ranges::stable_sort(in_order, {}, [](const dynablox_twin::Index& v) {
      return dynablox_twin::Index{v[0] >> 3, v[1] >> 3, v[2] >> 3};
    });
    const auto expected = dynablox_twin::twin_clusters(occupied, in_order, config);
    const dynablox::Clusters found = dynablox::find_clusters(scan, seeds, grid, config);
    std::size_t kept = 0;
    for (const dynablox_twin::TwinCluster& cluster : expected) {
      std::vector<std::size_t> members;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto cell = [](float c) { return static_cast<long>(std::floor(c)); };
        if (cluster.all.contains({cell(points[i].z), cell(points[i].y), cell(points[i].x)})) {
          members.push_back(i);
        }
      }
      const bool drops = static_cast<int>(members.size()) < config.min_cluster_points;
      for (const std::size_t i : members) {
        ASSERT_EQ(found.of_point[i], drops ? dynablox::kNoCluster : kept) << "round " << round;
      }
      kept += drops ? 0 : 1;
      merged += cluster.all.size() > cluster.voxels.size();
    }
    ASSERT_EQ(found.clusters.size(), kept);
    found_clusters += kept;
  }
  EXPECT_GT(merged, 100U);
  EXPECT_GT(found_clusters, 1000U);
}

TEST(DynabloxDepthBounds, HoldForEveryPlaceInRandomRectangles) {
  std::mt19937 random(8);
  const auto below = [&](int count) {
    return static_cast<int>(random() % static_cast<unsigned>(count));
  };
  std::size_t free = 0;
  for (int round = 0; round < 40; ++round) {
    tsdf::RangeImage image{.rows = 3 + below(60), .columns = 5 + below(300), .ranges_m = {}};
    image.ranges_m.resize(static_cast<std::size_t>((image.rows + 1) * image.columns));
    for (std::size_t i = 0; i < static_cast<std::size_t>(image.rows * image.columns); ++i) {
      image.ranges_m[i] = random() % 9 == 0 ? 0 : 1 + static_cast<float>(random() % 4096) / 512;
    }
    const tsdf::DepthBounds bounds(image);
    for (int rectangle = 0; rectangle < 20; ++rectangle) {
      const int first_row = below(image.rows),
                last_row = std::min(image.rows - 1, first_row + below(20));
      const int first_column = below(image.columns - 1);
      const int last_column = std::min(image.columns - 2, first_column + below(60));
      const auto [least, greatest] = bounds.within(first_row, last_row, first_column, last_column);
      free += least > 0;
      for (int i = 0; i < 50; ++i) {
        const float share = static_cast<float>(random() % 256) / 256;
        const float row = static_cast<float>(first_row + below(last_row - first_row + 1)) + share;
        const float column =
            static_cast<float>(first_column + below(last_column - first_column + 1)) + share;
        const float depth = tsdf::depth_at(image, {row, column}, 0.2F);
        ASSERT_GE(depth, least * (1 - 1e-6F));
        ASSERT_LE(depth, greatest * (1 + 1e-6F));
      }
    }
  }
  EXPECT_GT(free, 100U);
}

}  // namespace
}  // namespace mosbench
