#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/methods/octomap/log_odds_map.hpp"
#include "core/methods/octomap/pipeline.hpp"
#include "tests/small_world.hpp"

/// octomap against the library's own insertPointCloud.
namespace mosbench {
namespace {

using OctoCell = std::array<std::int32_t, 3>;

/// The library's map of the same scans.
class LibraryMap {
 public:
  LibraryMap(const octomap::Config& config, const VoxelGrid& grid)
      : config_(config), grid_(grid), tree_(config.voxel_size_m) {
    tree_.setProbHit(config.hit_probability);
    tree_.setProbMiss(config.miss_probability);
    tree_.setClampingThresMin(config.lowest_probability);
    tree_.setClampingThresMax(config.highest_probability);
  }

  void enter(const std::vector<Point>& points, const Pose& pose) {
    ::octomap::Pointcloud cloud;
    for (const Point& p : points) {
      if (takes_part(p)) cloud.push_back(position(p, pose));
    }
    tree_.insertPointCloud(cloud, position({0, 0, 0, 0}, pose), config_.max_range_m, true);
  }

  /// Log-odds of a point's voxel, if it takes part and the voxel was observed.
  std::optional<float> log_odds_of(const Point& p, const Pose& pose) const {
    if (!takes_part(p)) return std::nullopt;
    const ::octomap::point3d at = position(p, pose), sensor = position({0, 0, 0, 0}, pose);
    if ((at - sensor).norm() > config_.max_range_m) return std::nullopt;
    const ::octomap::OcTreeNode* node = tree_.search(at);
    if (node == nullptr) return std::nullopt;
    return node->getLogOdds();
  }

  std::map<OctoCell, float> leaves() const {
    std::map<OctoCell, float> all;
    for (auto leaf = tree_.begin_leafs(); leaf != tree_.end_leafs(); ++leaf) {
      const ::octomap::OcTreeKey key = leaf.getKey();
      all[{key[0] - 32768, key[1] - 32768, key[2] - 32768}] = leaf->getLogOdds();
    }
    return all;
  }

 private:
  bool takes_part(const Point& p) const {
    const Eigen::Vector3d in_sensor(p.x, p.y, p.z);
    return in_sensor.allFinite() && in_sensor.norm() > config_.min_range_m;
  }
  ::octomap::point3d position(const Point& p, const Pose& pose) const {
    const Eigen::Vector3d origin_m = grid_.origin_voxels * grid_.voxel_size_m;
    const Eigen::Vector3d sensor_m = pose.translation() - origin_m;
    const Eigen::Vector3f at =
        (pose.linear() * Eigen::Vector3d(p.x, p.y, p.z) + sensor_m).cast<float>();
    return {at.x(), at.y(), at.z()};
  }

  octomap::Config config_;
  VoxelGrid grid_;
  ::octomap::OcTree tree_;
};

octomap::Config small_octomap(unsigned seed) {
  octomap::Config config;
  config.voxel_size_m = seed % 2 == 0 ? 0.3 : 0.2;
  config.min_range_m = 0.3;
  config.max_range_m = seed % 3 == 1 ? 2.5 : 6.0;
  return config;
}

SmallWorld octomap_world(unsigned seed) {
  return small_world({.seed = seed,
                      .scans = 12,
                      .origin_m = {seed % 2 == 0 ? 0.0 : 446'123.4, -31.7, 412.3},
                      .defects = seed % 4 == 3});
}

TEST(OctomapAgainstTheLibrary, HasTheSameLeavesBitForBit) {
  std::size_t leaves = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const SmallWorld world = octomap_world(seed);
    const octomap::Config config = small_octomap(seed);
    const VoxelGrid grid = grid_around(world.poses[0].translation(), config.voxel_size_m);
    LibraryMap library(config, grid);
    octomap::LogOddsMap map(config);
    std::vector<RayWindow> windows;
    ThreadPool pool(1 + seed % 3);
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      PosedScan scan;
      scan.points = world.scans[k];
      scan.map_from_sensor = world.poses[k];
      map.enter(octomap::update_of(scan, grid, config, windows, pool));
      library.enter(world.scans[k], world.poses[k]);
    }
    std::map<OctoCell, float> ours;
    for (const octomap::Leaf& leaf : map.leaves()) {
      ours[{leaf.voxel.x, leaf.voxel.y, leaf.voxel.z}] = leaf.log_odds;
    }
    leaves += ours.size();
    ASSERT_EQ(ours, library.leaves()) << "seed " << seed;
  }
  EXPECT_GT(leaves, 10'000U);
}

TEST(OctomapAgainstTheLibrary, GivesTheSameLabelsBeforeAfterAndAtTheEnd) {
  std::size_t moving = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const SmallWorld world = octomap_world(seed);
    for (const auto when : {octomap::When::kBefore, octomap::When::kAfter, octomap::When::kFinal}) {
      octomap::Config config = small_octomap(seed);
      config.when = when;
      const auto method = octomap::make_pipeline(config, {.scores = true});
      const std::vector<LabelledScan> results = results_of(*method, world);
      ASSERT_EQ(results.size(), world.scans.size());
      LibraryMap library(config, grid_around(world.poses[0].translation(), config.voxel_size_m));
      const auto expect_labels = [&](std::size_t k) {
        for (std::size_t i = 0; i < world.scans[k].size(); ++i) {
          const auto log_odds = library.log_odds_of(world.scans[k][i], world.poses[k]);
          const bool moves = log_odds && *log_odds < 0;
          ASSERT_EQ(results[k].labels[i], moves ? kMovingLabel : kStaticLabel)
              << "seed " << seed << " scan " << k << " point " << i;
          ASSERT_EQ(results[k].scores[i], log_odds ? -*log_odds : 0.0F);
          moving += moves;
        }
      };
      for (std::size_t k = 0; k < world.scans.size(); ++k) {
        if (when == octomap::When::kBefore) expect_labels(k);
        library.enter(world.scans[k], world.poses[k]);
        if (when == octomap::When::kAfter) expect_labels(k);
      }
      for (std::size_t k = 0; when == octomap::When::kFinal && k < results.size(); ++k) {
        expect_labels(k);
      }
    }
  }
  EXPECT_GT(moving, 1000U);
}

/// Sets of cells and a hash of log-odds: what the update is, without the library.
TEST(OctomapAgainstSets, CountsAHitOrAMissOncePerScanAndCell) {
  octomap::Config config = small_octomap(0);
  const SmallWorld world = octomap_world(0);
  const VoxelGrid grid = grid_around(world.poses[0].translation(), config.voxel_size_m);
  octomap::LogOddsMap map(config);
  std::vector<RayWindow> windows;
  ThreadPool pool(1);
  std::map<OctoCell, float> expected;
  const auto log_odds = [](double p) { return static_cast<float>(std::log(p / (1 - p))); };
  const auto add = [&](const OctoCell& cell, double probability) {
    float& value = expected[cell];
    value = std::clamp(value + log_odds(probability), log_odds(config.lowest_probability),
                       log_odds(config.highest_probability));
  };
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    PosedScan scan;
    scan.points = world.scans[k];
    scan.map_from_sensor = world.poses[k];
    const octomap::ScanUpdate update = octomap::update_of(scan, grid, config, windows, pool);
    map.enter(update);
    std::set<OctoCell> hit, free;
    for (std::size_t i = 0; i < update.hit.block_count(); ++i) {
      for_each_cell(update.hit.masks[i], [&](std::uint32_t cell) {
        const Voxel v = voxel_at(update.hit.blocks[i], cell);
        hit.insert({v.x, v.y, v.z});
      });
    }
    for (std::size_t i = 0; i < update.free.blocks.size(); ++i) {
      for_each_cell(update.free.masks[i], [&](std::uint32_t cell) {
        const Voxel v = voxel_at(update.free.blocks[i], cell);
        free.insert({v.x, v.y, v.z});
      });
    }
    for (const OctoCell& cell : free) {
      if (!hit.contains(cell)) add(cell, config.miss_probability);
    }
    for (const OctoCell& cell : hit) add(cell, config.hit_probability);
  }
  std::map<OctoCell, float> ours;
  for (const octomap::Leaf& leaf : map.leaves()) {
    ours[{leaf.voxel.x, leaf.voxel.y, leaf.voxel.z}] = leaf.log_odds;
  }
  ASSERT_GT(ours.size(), 1000U);
  EXPECT_EQ(ours, expected);
}

}  // namespace
}  // namespace mosbench
