#include "core/voxel/voxelize.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

VoxelizedScan voxelize_at_origin(const std::vector<Point>& points, double voxel_size_m = 0.25,
                                 double min_range_m = 0.0, double max_range_m = 10.0,
                                 unsigned threads = 1) {
  ThreadPool pool(threads);
  return voxelize(points, Pose::Identity(), VoxelGrid{.voxel_size_m = voxel_size_m}, min_range_m,
                  max_range_m, pool);
}

Triple voxel_of_point(const VoxelizedScan& scan, std::size_t point) {
  const std::uint32_t number = scan.voxel_of_point[point];
  return triple(voxel_at(scan.measured.blocks[number / kBlockVoxels], number % kBlockVoxels));
}

TEST(Voxelize, RoundsTowardMinusInfinity) {
  const VoxelizedScan scan = voxelize_at_origin(
      {{0.25F, 0, 0, 0}, {0.2499F, 0, 0, 0}, {-0.0001F, 0, 0, 0}, {-0.25F, -0.2501F, -2.0F, 0}});
  EXPECT_EQ(voxel_of_point(scan, 0), (Triple{1, 0, 0}));
  EXPECT_EQ(voxel_of_point(scan, 1), (Triple{0, 0, 0}));
  EXPECT_EQ(voxel_of_point(scan, 2), (Triple{-1, 0, 0}));
  EXPECT_EQ(voxel_of_point(scan, 3), (Triple{-1, -2, -8}));
  EXPECT_EQ(scan.measured.block_count(), 3U);
}

TEST(Voxelize, LeavesOutPointsExactlyAtTheMinimumRange) {
  const VoxelizedScan scan = voxelize_at_origin(
      {{3, 4, 0, 0}, {0, 0, 5, 0}, {0, 0, std::nextafter(5.0F, 6.0F), 0}, {1, 1, 1, 0}}, 0.25, 5.0);
  EXPECT_EQ(scan.voxel_of_point[0], kNoVoxel);
  EXPECT_EQ(scan.voxel_of_point[1], kNoVoxel);
  EXPECT_NE(scan.voxel_of_point[2], kNoVoxel);
  EXPECT_EQ(scan.voxel_of_point[3], kNoVoxel);
  EXPECT_EQ(scan.nonfinite_points, 0U);
  EXPECT_EQ(scan.occupied_count, 1U);
}

TEST(Voxelize, MeasuresRangesFromEachPointsOwnOrigin) {
  // Points 1, 6 and 11 m from the first sensor, which are 9, 4 and 1 m from the second.
  const std::vector<Point> line = {{1, 0, 0, 0}, {6, 0, 0, 0}, {11, 0, 0, 0},
                                   {1, 0, 0, 0}, {6, 0, 0, 0}, {11, 0, 0, 0}};
  const RayOrigins origins{{{0, 0, 0}, {10, 0, 0}}, {0, 0, 0, 1, 1, 1}};
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0, 2, 0);
  ThreadPool pool(2);
  const VoxelizedScan scan =
      voxelize(line, pose, VoxelGrid{.voxel_size_m = 0.25}, 3, 8, pool, origins);
  EXPECT_EQ(scan.voxel_of_point[0], kNoVoxel);
  EXPECT_NE(scan.voxel_of_point[1], kNoVoxel);
  EXPECT_NE(scan.voxel_of_point[2], kNoVoxel);
  EXPECT_NE(scan.voxel_of_point[3], kNoVoxel);
  EXPECT_EQ(scan.voxel_of_point[4], scan.voxel_of_point[1]);
  EXPECT_EQ(scan.voxel_of_point[5], kNoVoxel);
  EXPECT_EQ(triples(scan.measured), (Triples{{4, 8, 0}, {24, 8, 0}, {44, 8, 0}}));
  EXPECT_EQ(scan.occupied_count, 1U) << "9 and 11 m are beyond the range";
  ASSERT_EQ(scan.by_origin.size(), 2U);
  EXPECT_EQ(triples(scan.by_origin[0].measured), (Triples{{24, 8, 0}, {44, 8, 0}}));
  EXPECT_EQ(triples(scan.by_origin[1].measured), (Triples{{4, 8, 0}, {24, 8, 0}}));
  EXPECT_EQ(triple(scan.by_origin[1].sensor_voxel), (Triple{40, 8, 0}));
}

TEST(Voxelize, LeavesOutPointsAtTheSensorWithoutMinimumRange) {
  const VoxelizedScan scan = voxelize_at_origin({{0, 0, 0, 0}, {1e-3F, 0, 0, 0}});
  EXPECT_EQ(scan.voxel_of_point[0], kNoVoxel);
  EXPECT_NE(scan.voxel_of_point[1], kNoVoxel);
}

TEST(Voxelize, CountsNonfinitePointsAndLeavesThemOut) {
  const VoxelizedScan scan = voxelize_at_origin({{kNan, 1, 1, 0},
                                                 {1, kInfinity, 1, 0},
                                                 {1, 1, -kInfinity, 0},
                                                 {kInfinity, -kInfinity, kNan, 0},
                                                 {1, 1, 1, kNan}});
  EXPECT_EQ(scan.nonfinite_points, 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scan.voxel_of_point[i], kNoVoxel);
  EXPECT_EQ(voxel_of_point(scan, 4), (Triple{4, 4, 4}));
}

TEST(Voxelize, KeepsMeasuredVoxelsBeyondTheRangeOutOfTheOccupied) {
  // Lower corners at exactly 10 m count, a voxel farther does not.
  const VoxelizedScan scan =
      voxelize_at_origin({{10.1F, 0.1F, 0.1F, 0}, {10.3F, 0.1F, 0.1F, 0}, {6.1F, 8.1F, 0.1F, 0}});
  EXPECT_EQ(triples(scan.measured), (Triples{{40, 0, 0}, {41, 0, 0}, {24, 32, 0}}));
  EXPECT_EQ(triples(scan.measured.blocks, scan.occupied), (Triples{{40, 0, 0}, {24, 32, 0}}));
  EXPECT_EQ(scan.occupied_count, 2U);
}

TEST(Voxelize, RangeIsCutAtEachVoxelsOwnLowerCorner) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-4.0F, 4.0F);
  std::vector<Point> points(20'000);
  for (Point& p : points) p = {coordinate(random), coordinate(random), coordinate(random), 0};
  ThreadPool pool(1);
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d{0.3, -0.7, 0.2};
  for (const double range_m : {1.0, 2.0, 2.83, 3.7}) {
    const VoxelizedScan scan =
        voxelize(points, pose, VoxelGrid{.voxel_size_m = 0.2}, 0.0, range_m, pool);
    Triples expected;
    for (const Triple& v : triples(scan.measured)) {
      const double x = v[0] * 0.2 - 0.3, y = v[1] * 0.2 + 0.7, z = v[2] * 0.2 - 0.2;
      if (x * x + y * y + z * z <= range_m * range_m) expected.insert(v);
    }
    ASSERT_GT(expected.size(), 100U);
    ASSERT_LT(expected.size(), triples(scan.measured).size());
    EXPECT_EQ(triples(scan.measured.blocks, scan.occupied), expected);
    EXPECT_EQ(scan.occupied_count, expected.size());
  }
}

TEST(Voxelize, TakesPointsThroughThePoseIntoTheGrid) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d{100.1, -50.1, 3.1};
  ThreadPool pool(1);
  const VoxelGrid grid{.voxel_size_m = 0.5, .origin_voxels = {200, -104, 0}};
  const VoxelizedScan scan =
      voxelize(std::vector<Point>{{2.0F, 1.0F, 0.5F, 0}}, pose, grid, 0.5, 10, pool);
  // (-1, 2, 0.5) + t = (99.1, -48.1, 3.6): voxel (198, -97, 7) less the origin.
  EXPECT_EQ(voxel_of_point(scan, 0), (Triple{-2, 7, 7}));
  EXPECT_EQ(triple(scan.sensor_voxel), (Triple{0, 3, 6}));
}

TEST(Voxelize, OverflowNamesTheFirstPointForAnyThreadCount) {
  std::vector<Point> points(5000, {1, 1, 1, 0});
  points[1234] = {2e5F, 0, 0, 0};
  for (std::size_t i = 2500; i < points.size(); i += 7) points[i] = {0, 0, -3e38F, 0};
  for (const unsigned threads : {1U, 2U, 7U}) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      try {
        voxelize_at_origin(points, 0.25, 0.0, 10.0, threads);
        FAIL() << "no error";
      } catch (const std::range_error& error) {
        EXPECT_THAT(error.what(), testing::StartsWith("point 1234: "));
      }
    }
  }
}

TEST(Voxelize, FarthestVoxelThatFitsIsTaken) {
  const float last_m = 0.25F * ((1 << 19) - 1);
  EXPECT_EQ(voxel_of_point(voxelize_at_origin({{last_m, 0, 0, 0}}), 0)[0], (1 << 19) - 1);
  EXPECT_THROW(voxelize_at_origin({{last_m + 0.25F, 0, 0, 0}}), std::range_error);
}

TEST(Voxelize, SensorBeyondTheGridIsRefused) {
  const VoxelGrid grid{.voxel_size_m = 0.25};
  EXPECT_THROW(voxel_of({3e6, 0, 0}, grid), std::range_error);
  EXPECT_THROW(voxel_of({0, std::nan(""), 0}, grid), std::range_error);
  EXPECT_EQ(triple(voxel_of({-0.1, 0.25, -2e6}, grid)), (Triple{-1, 1, -8'000'000}));
}

TEST(Voxelize, PointsKeepTheirVoxelsForAnyThreadCount) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(-6.0F, 6.0F);
  std::vector<Point> points(4'001);
  for (Point& p : points) p = {coordinate(random), coordinate(random), coordinate(random), 0};
  points[17].x = kNan;
  const VoxelizedScan one = voxelize_at_origin(points, 0.3, 1.0);
  for (const unsigned threads : {2U, 7U}) {
    const VoxelizedScan many = voxelize_at_origin(points, 0.3, 1.0, 10.0, threads);
    EXPECT_EQ(triples(many.measured), triples(one.measured));
    EXPECT_EQ(many.nonfinite_points, 1U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(many.voxel_of_point[i] == kNoVoxel, one.voxel_of_point[i] == kNoVoxel);
      if (one.voxel_of_point[i] == kNoVoxel) continue;
      ASSERT_EQ(voxel_of_point(many, i), voxel_of_point(one, i));
    }
  }
}

TEST(Voxelize, EmptyScanIsAnEmptySet) {
  const VoxelizedScan scan = voxelize_at_origin({}, 0.25, 0.0, 10.0, 3);
  EXPECT_EQ(scan.measured.block_count(), 0U);
  EXPECT_EQ(scan.occupied_count, 0U);
}

}  // namespace
}  // namespace mosbench
