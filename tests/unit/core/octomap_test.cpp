#include <gtest/gtest.h>

#include <map>

#include "core/methods/octomap/log_odds_map.hpp"
#include "core/methods/octomap/pipeline.hpp"

namespace mosbench::octomap {
namespace {

Config metre_voxels() {
  Config config;
  config.voxel_size_m = 1;
  config.min_range_m = 0.2;
  config.max_range_m = 20;
  return config;
}

Pose in_the_middle() {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d::Constant(0.5);
  return pose;
}

/// A map with a grid around 0 that scans enter from (0.5, 0.5, 0.5).
struct MetreMap {
  LogOddsMap map{metre_voxels()};
  std::vector<RayWindow> windows;
  ThreadPool pool{1};

  void enter(std::vector<Point> points) {
    PosedScan scan;
    scan.points = std::move(points);
    scan.map_from_sensor = in_the_middle();
    map.enter(update_of(scan, {.voxel_size_m = 1}, metre_voxels(), windows, pool));
  }
  /// Log-odds along x.
  std::map<std::int32_t, float> row() const {
    std::map<std::int32_t, float> row;
    for (const Leaf& leaf : map.leaves()) {
      EXPECT_EQ(leaf.voxel.y, 0);
      EXPECT_EQ(leaf.voxel.z, 0);
      row[leaf.voxel.x] = leaf.log_odds;
    }
    return row;
  }
};

TEST(OctomapMap, HasAHitAtTheEndOfARayAndMissesBefore) {
  MetreMap scans;
  scans.enter({{4, 0, 0, 0}});
  const auto row = scans.row();
  ASSERT_EQ(row.size(), 5U);
  for (const std::int32_t x : {0, 1, 2, 3}) EXPECT_NEAR(row.at(x), -0.405465F, 1e-6);
  EXPECT_NEAR(row.at(4), 0.847298F, 1e-6);
}

TEST(OctomapMap, HasMissesAloneOnARayThatIsCut) {
  MetreMap scans;
  scans.enter({{30, 0, 0, 0}});
  const auto row = scans.row();
  ASSERT_EQ(row.size(), 20U);
  for (const auto& [x, log_odds] : row) EXPECT_NEAR(log_odds, -0.405465F, 1e-6) << x;
}

TEST(OctomapMap, CountsAVoxelThatIsHitAndCrossedAsHit) {
  MetreMap scans;
  scans.enter({{2, 0, 0, 0}, {4, 0, 0, 0}, {4, 0.1F, 0, 0}});
  EXPECT_NEAR(scans.row().at(2), 0.847298F, 1e-6);
  EXPECT_NEAR(scans.row().at(4), 0.847298F, 1e-6);  // once
}

TEST(OctomapMap, ClampsSoThatNineMissesFreeWhatWasHitLong) {
  MetreMap scans;
  for (int k = 0; k < 8; ++k) scans.enter({{2, 0, 0, 0}});
  EXPECT_NEAR(scans.row().at(2), 3.5110F, 1e-3);
  for (int misses = 1; misses <= 9; ++misses) {
    scans.enter({{4, 0, 0, 0}});
    EXPECT_EQ(scans.row().at(2) < 0, misses == 9) << misses;
  }
  for (int k = 0; k < 20; ++k) scans.enter({{4, 0, 0, 0}});
  EXPECT_NEAR(scans.row().at(2), -2.0F, 1e-3);
  for (int hits = 1; hits <= 3; ++hits) {
    scans.enter({{2, 0, 0, 0}});
    EXPECT_EQ(scans.row().at(2) >= 0, hits == 3) << hits;
  }
}

TEST(OctomapMap, ForgetsWhatIsFarAndKeepsTheRestBitForBit) {
  MetreMap scans;
  scans.enter({{18, 0, 0, 0}});
  const auto before = scans.row();
  scans.map.keep_within({0, 0, 0}, 9);
  const auto after = scans.row();
  ASSERT_EQ(after.size(), 16U);  // two blocks
  for (const auto& [x, log_odds] : after) EXPECT_EQ(log_odds, before.at(x));
  scans.enter({{18, 0, 0, 0}});
  EXPECT_NEAR(scans.row().at(18), 0.847298F, 1e-6);
}

std::vector<LabelledScan> run(When when, const std::vector<std::vector<Point>>& scans) {
  Config config = metre_voxels();
  config.when = when;
  const auto method = make_pipeline(config);
  std::vector<LabelledScan> all;
  for (const std::vector<Point>& points : scans) {
    for (LabelledScan& scan : method->push(points, in_the_middle())) all.push_back(scan);
  }
  for (LabelledScan& scan : method->finish()) all.push_back(scan);
  return all;
}

TEST(Octomap, FindsAPointInAVoxelThatWasSeenFreeOnceOnlyBeforeItsScanEnters) {
  const std::vector<std::vector<Point>> scans = {{{4, 0, 0, 0}}, {{2, 0, 0, 0}}};
  EXPECT_EQ(run(When::kBefore, scans)[1].labels[0], kMovingLabel);
  EXPECT_EQ(run(When::kAfter, scans)[1].labels[0], kStaticLabel);
  EXPECT_EQ(run(When::kFinal, scans)[1].labels[0], kStaticLabel);
}

TEST(Octomap, FindsAtTheEndWhatLeft) {
  const std::vector<std::vector<Point>> scans = {
      {{2, 0, 0, 0}}, {{4, 0, 0, 0}}, {{4, 0, 0, 0}}, {{4, 0, 0, 0}}};
  EXPECT_EQ(run(When::kBefore, scans)[0].labels[0], kStaticLabel);
  EXPECT_EQ(run(When::kFinal, scans)[0].labels[0], kMovingLabel);
}

TEST(Octomap, CutsRaysAtTheRangeLimitWithoutAHit) {
  const auto scans = run(When::kBefore, {{{30, 0, 0, 0}}, {{18, 0, 0, 0}}, {{30, 0, 0, 0}}});
  EXPECT_EQ(scans[1].labels[0], kMovingLabel);
  EXPECT_EQ(scans[2].labels[0], kStaticLabel);
}

TEST(Octomap, LabelsATripBeyondTheReachOfTheTree) {
  const auto method = make_pipeline(metre_voxels());
  Pose pose = in_the_middle();
  for (int k = 0; k < 10; ++k) {
    pose.translation().x() += 10'000;  // 100 km, three times the reach
    const std::vector<Point> far = {{8, 0, 0, 0}}, near = {{3, 0, 0, 0}};
    EXPECT_EQ(method->push(far, pose)[0].labels[0], kStaticLabel);
    EXPECT_EQ(method->push(near, pose)[0].labels[0], kMovingLabel);
  }
  Config config = metre_voxels();
  config.when = When::kFinal;
  const auto final_map = make_pipeline(config);
  final_map->push(std::vector<Point>{{8, 0, 0, 0}}, in_the_middle());
  EXPECT_THROW(final_map->push(std::vector<Point>{{8, 0, 0, 0}}, pose), std::range_error);
}

}  // namespace
}  // namespace mosbench::octomap
