#include "eval/static_map/static_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "datasets/formats/scan_file.hpp"
#include "datasets/text/errors.hpp"
#include "eval/static_map/floor_plan.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

JudgedScan scan_at(const Eigen::Vector3d& sensor_m, const std::vector<Point>& points,
                   PointOutcome outcome) {
  JudgedScan scan;
  scan.frame.points = points;
  scan.frame.map_from_sensor.translation() = sensor_m;
  scan.outcomes.assign(points.size(), outcome);
  return scan;
}

std::vector<MapPoint> points_of(const StaticMap& map) {
  std::vector<MapPoint> points;
  map.for_each([&](const MapPoint& point) { points.push_back(point); });
  return points;
}

TEST(StaticMap, KeepsTheFirstStaticPointOfEachVoxel) {
  const TempFolder folder;
  StaticMap map({.voxel_m = 1.0, .range = {0.5, 20.0}}, folder / "tiles");
  const Point near{0.25F, 0, 0, 1}, first{2.25F, -0.5F, 0, 2}, second{2.75F, -0.25F, 0, 3},
      far{30, 0, 0, 4}, nowhere{0, 0, 0, 5};
  map.add(scan_at({10, 0, 0}, {near, first, second, far, nowhere}, PointOutcome::kIgnoredStatic));
  map.add(scan_at({10, 0, 0}, {{5, 5, 5, 6}}, PointOutcome::kFalsePositive));
  const std::vector<MapPoint> points = points_of(map);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].position_map_m, Eigen::Vector3d(12.25, -0.5, 0));
  EXPECT_EQ(points[0].intensity, 2);
  EXPECT_EQ(map.size(), 1U);
}

TEST(StaticMap, LeavesOutByMajorityAndCountsGhosts) {
  const TempFolder folder;
  StaticMap map({.voxel_m = 1.0, .by_majority = true}, folder / "tiles");
  const std::vector<Point> ghost = {{1.5F, 0.5F, 0.5F, 0}}, wall = {{3.5F, 0.5F, 0.5F, 0}},
                           left = {{5.5F, 0.5F, 0.5F, 0}};
  map.add(scan_at(Eigen::Vector3d::Zero(), ghost, PointOutcome::kTruePositive));
  map.add(scan_at(Eigen::Vector3d::Zero(), ghost, PointOutcome::kFalseNegative));
  for (int k = 0; k < 2; ++k)
    map.add(scan_at(Eigen::Vector3d::Zero(), wall, PointOutcome::kTrueNegative));
  map.add(scan_at(Eigen::Vector3d::Zero(), wall, PointOutcome::kFalsePositive));
  map.add(scan_at(Eigen::Vector3d::Zero(), left, PointOutcome::kFalseNegative));
  EXPECT_EQ(map.size(), 2U) << "the wall, and what was missed alone";
  const MapCounts truth = map.voxels_with_truth();
  EXPECT_EQ(truth.static_points, 1U);
  EXPECT_EQ(truth.kept_static, 1U);
  EXPECT_EQ(truth.dynamic_points, 2U);
  EXPECT_EQ(truth.removed_dynamic, 1U);
}

/// A drive there and back again, so that tiles that waited in files are met again.
void drive(StaticMap& map) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> around_m(-30.0F, 30.0F);
  for (int k = 0; k < 40; ++k) {
    std::vector<Point> points;
    for (int i = 0; i < 500; ++i) points.push_back({around_m(random), around_m(random), 0.3F, 1});
    const double way_m = 25.0 * (k < 20 ? k : 40 - k);
    map.add(scan_at({way_m, -way_m, 0}, points,
                    k % 3 == 0 ? PointOutcome::kTruePositive : PointOutcome::kTrueNegative));
  }
}

TEST(StaticMap, IsTheSameWhenTilesWaitInFiles) {
  const TempFolder folder;
  {
    StaticMap whole({.voxel_m = 0.2, .by_majority = true}, folder / "never");
    StaticMap spilling({.voxel_m = 0.2, .by_majority = true, .most_voxels = 2000},
                       folder / "tiles");
    drive(whole);
    drive(spilling);
    EXPECT_FALSE(is_there(folder / "never"));
    ASSERT_TRUE(is_there(folder / "tiles")) << "memory was never full";
    const std::vector<MapPoint> expected = points_of(whole), points = points_of(spilling);
    ASSERT_GT(expected.size(), 10'000U);
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(points[i].position_map_m, expected[i].position_map_m);
    }
    EXPECT_EQ(spilling.voxels_with_truth().removed_dynamic,
              whole.voxels_with_truth().removed_dynamic);
  }
  EXPECT_FALSE(is_there(folder / "tiles"));
}

TEST(StaticMap, IsReadAgainFromItsFiles) {
  const TempFolder folder;
  StaticMap map({.voxel_m = 0.5}, folder / "tiles");
  map.add(scan_at({1, 2, 3}, {{4, 5, 6, 7}, {-9, -8, -7, 6}}, PointOutcome::kTrueNegative));
  std::string ply, pcd;
  format_ply(map, [&](std::string_view bytes) { ply += bytes; });
  format_pcd(map, "map.pcd", [&](std::string_view bytes) { pcd += bytes; });
  for (const auto& [name, bytes] : {std::pair("map.ply", ply), std::pair("map.pcd", pcd)}) {
    write_file_atomic(folder / name, bytes);
    const std::vector<Point> points = read_scan(folder / name);
    ASSERT_EQ(points.size(), 2U) << name;
    EXPECT_EQ(points[0].x, -8);
    EXPECT_EQ(points[1].z, 9);
    EXPECT_EQ(points[1].intensity, 7);
  }
}

TEST(StaticMap, RefusesFloat32WhereItIsTooCoarse) {
  const TempFolder folder;
  StaticMap map({}, folder / "tiles");
  map.add(scan_at({2e6, 0, 0}, {{4, 5, 6, 7}}, PointOutcome::kTrueNegative));
  try {
    format_pcd(map, "map.pcd", [](std::string_view) {});
    FAIL() << "nothing was thrown";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a .ply, which has float64"));
  }
}

/// A floor of 8 by 8 m with a wall at x = 5 m and a sign 3 m above it at x = 3 m.
JudgedScan room(double sensor_z_m) {
  std::vector<Point> points;
  for (int i = 0; i < 80; ++i) {
    for (int k = -40; k < 40; ++k) {
      const float x_m = 0.1F * static_cast<float>(i) + 0.05F;
      const float y_m = 0.1F * static_cast<float>(k) + 0.05F;
      const auto z_m = static_cast<float>(-sensor_z_m);
      if (x_m < 5.0F) points.push_back({x_m, y_m, z_m, 0});
      if (i == 50) {
        for (int up = 0; up < 20; ++up) {
          points.push_back({5.05F, y_m, z_m + 0.1F * static_cast<float>(up), 0});
        }
      }
      if (i == 30 && k == 0) points.push_back({x_m, y_m, z_m + 3.0F, 0});
    }
  }
  return scan_at({0, 0, sensor_z_m}, points, PointOutcome::kTrueNegative);
}

TEST(FloorPlan, TellsWallsFromFloorAndWhatHangsAbove) {
  const TempFolder folder;
  StaticMap map({}, folder / "tiles");
  FreeCells free(0.1, {});
  const JudgedScan scan = room(1.0);
  map.add(scan);
  free.add(scan, kNoLimits);
  const FloorPlan plan = floor_plan(map, free, {}, "at/plan.pgm");
  EXPECT_EQ(plan.occupied, 80U) << "the wall, a cell thick";
  EXPECT_GT(plan.free, 3900U);
  EXPECT_LT(plan.free, 4300U);
  EXPECT_THAT(plan.yaml, HasSubstr("image: plan.pgm\nresolution: 0.1\norigin: ["));
  const std::size_t head = plan.pgm.find("255\n") + 4;
  EXPECT_EQ(static_cast<std::size_t>(std::count(
                plan.pgm.begin() + static_cast<std::ptrdiff_t>(head), plan.pgm.end(), '\0')),
            plan.occupied);
}

TEST(FloorPlan, HasItsCornerWhereTheYamlSaysAndNorthUp) {
  const TempFolder folder;
  StaticMap map({.voxel_m = 1.0}, folder / "tiles");
  std::vector<Point> points = {{2.5F, 3.5F, 0, 0}, {2.5F, 3.5F, 1, 0}, {4.5F, 6.5F, 0, 0}};
  map.add(scan_at({0, 0, 0}, points, PointOutcome::kTrueNegative));
  const FloorPlan plan = floor_plan(map, FreeCells(1.0, {}), {}, "plan.pgm");
  EXPECT_THAT(plan.yaml, HasSubstr("origin: [2, 3, 0.0]"));
  const std::string cells = plan.pgm.substr(plan.pgm.find("255\n") + 4);
  ASSERT_EQ(cells.size(), 12U);
  EXPECT_EQ(static_cast<unsigned char>(cells[9]), 0) << "south-west: something stands there";
  EXPECT_EQ(static_cast<unsigned char>(cells[2]), 254) << "north-east: ground";
  EXPECT_EQ(static_cast<unsigned char>(cells[0]), 205);
}

TEST(FloorPlan, RefusesMoreCellsThanFit) {
  const TempFolder folder;
  StaticMap map({.voxel_m = 0.1}, folder / "tiles");
  map.add(scan_at(Eigen::Vector3d::Zero(), {{1, 1, 0, 0}}, PointOutcome::kTrueNegative));
  map.add(scan_at({1e5, 1e5, 0}, {{1, 1, 0, 0}}, PointOutcome::kTrueNegative));
  EXPECT_THROW(floor_plan(map, FreeCells(0.1, {}), {}, "plan.pgm"), DataError);
}

}  // namespace
}  // namespace mosbench
