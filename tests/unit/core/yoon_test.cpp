#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/methods/yoon/growth.hpp"
#include "core/methods/yoon/pipeline.hpp"

namespace mosbench::yoon {
namespace {

using Flags = std::vector<std::uint8_t>;

constexpr double kPixel_rad = 0.0157;

TEST(YoonBoxFilter, RemovesALoneSeedAmongStaticPointsAndKeepsFiveTogether) {
  std::vector<Direction> row;
  for (int i = 0; i < 9; ++i) {
    row.push_back({10, 0.1F + static_cast<float>(i * kPixel_rad), 0.2F});
  }
  EXPECT_EQ(filter_seeds(row, Flags{0, 0, 0, 0, 1, 0, 0, 0, 0}, kPixel_rad), Flags(9));
  const Flags five = {0, 0, 1, 1, 1, 1, 1, 0, 0};
  EXPECT_EQ(filter_seeds(row, five, kPixel_rad), five);
}

TEST(YoonBoxFilter, LooksAcrossTheEndsOfTheBearingsAndSkipsPointsOutOfRange) {
  const std::vector<Direction> points = {{10, 3.1415F, 0}, {10, -3.1415F, 0}, {10, -3.1415F, 0}};
  EXPECT_EQ(filter_seeds(points, Flags{1, 0, 0}, kPixel_rad), Flags(3));
  EXPECT_EQ(filter_seeds(points, Flags{1, 1, 0}, kPixel_rad), (Flags{1, 1, 0}));
  const std::vector<Direction> one_near = {{10, 3.1415F, 0}, {0, 0, 0}, {10, -3.1415F, 0}};
  EXPECT_EQ(filter_seeds(one_near, Flags{1, 0, 0}, kPixel_rad), (Flags{1, 0, 0}));
}

/// Points on a line along x, and one reference point far away or near some of them.
struct Line {
  std::vector<Eigen::Vector3f> points, reference;
  std::vector<Look> looks;

  Flags grown(Flags kept, const Config& config = {}) const {
    const Flags all(points.size(), 1), all_of_reference(reference.size(), 1);
    const PointCells cells(reference, all_of_reference, kFarthest_m);
    return grow(std::move(kept), {points, all, looks, reference, cells}, config);
  }
};

Line line_of(std::initializer_list<float> x) {
  Line line;
  for (const float at : x) line.points.emplace_back(at, 0, 0);
  line.looks.assign(line.points.size(), {Look::Finding::kOccupied, 0});
  return line;
}

TEST(YoonGrowth, ReachesNeighboursWithinItsDistanceOnly) {
  EXPECT_EQ(line_of({0, 0.29F, 0.58F}).grown({1, 0, 0}), (Flags{1, 1, 1}));
  EXPECT_EQ(line_of({0, 0.31F}).grown({1, 0}), (Flags{1, 0}));
}

TEST(YoonGrowth, ReachesOnlyPointsThatTheReferenceHasNotNear) {
  Line line = line_of({0, 0.29F});
  line.reference.emplace_back(0.29F, 0.2F, 0);
  EXPECT_EQ(line.grown({1, 0}), (Flags{1, 1}));
  line.reference[0].y() = 0.1F;
  EXPECT_EQ(line.grown({1, 0}), (Flags{1, 0}));
}

TEST(YoonGrowth, IsBlockedByAPlaneThatWasThere) {
  Line line = line_of({0, 0.29F});
  // A wall through the second point, with a hole around it.
  for (int a = -2; a <= 2; ++a) {
    for (int b = -2; b <= 2; ++b) {
      if (a == 0 && b == 0) continue;
      line.reference.emplace_back(0.29F, 0.2F * static_cast<float>(a),
                                  0.2F * static_cast<float>(b));
    }
  }
  EXPECT_EQ(line.grown({1, 0}), (Flags{1, 0}));
  Config without_planes;
  without_planes.planar_share = 0;
  EXPECT_EQ(line.grown({1, 0}, without_planes), (Flags{1, 1}));
}

TEST(YoonGrowth, GoesOneStepIntoUnknownSpace) {
  Line line = line_of({0, 0.2F, 0.4F});
  line.looks[1].finding = Look::Finding::kUnknown;
  line.looks[2].finding = Look::Finding::kUnknown;
  EXPECT_EQ(line.grown({1, 0, 0}), (Flags{1, 1, 0}));
}

TEST(YoonResidual, IsToThePlaneOfTenPointsOrToTheNearestOne) {
  std::vector<Eigen::Vector3f> floor;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      floor.emplace_back(0.1F * static_cast<float>(x) + 0.05F, 0.1F * static_cast<float>(y), 0);
    }
  }
  const Flags all(floor.size(), 1);
  const PointCells cells(floor, all, kFarthest_m);
  const Residual plane = residual_of({0, 0, 0.2F}, floor, cells, 0.05);
  EXPECT_TRUE(plane.to_plane);
  EXPECT_NEAR(plane.distance_m, 0.2F, 1e-6);
  const Residual point = residual_of({0, 0, 0.2F}, floor, cells, 0);
  EXPECT_FALSE(point.to_plane);
  EXPECT_NEAR(point.distance_m, std::hypot(0.05F, 0.2F), 1e-6);
  EXPECT_EQ(residual_of({0, 0, 5}, floor, cells, 0.05).distance_m, kFarthest_m);
}

/// A wall 10 m before the sensor, and a box of points that stands at `box_m` before it.
std::vector<Point> wall_and_box(float box_m) {
  std::vector<Point> points;
  for (float b = -0.3F; b < 0.3F; b += 0.01F) {
    for (float e = -0.2F; e < 0.2F; e += 0.01F) {
      const bool on_box = std::abs(b) < 0.06F && std::abs(e) < 0.06F;
      const float range_m = on_box && box_m > 0 ? box_m : 10;
      points.push_back({range_m * std::cos(e) * std::cos(b), range_m * std::cos(e) * std::sin(b),
                        range_m * std::sin(e), 0});
    }
  }
  return points;
}

TEST(Yoon, FindsABoxThatCameAndNotTheWallBehindABoxThatWent) {
  Config config;
  config.window_scans = 2;
  for (const LastStep step : {LastStep::kSeeds, LastStep::kBoxFilter, LastStep::kGrowth}) {
    config.last_step = step;
    Pipeline pipeline(config);
    std::vector<std::ptrdiff_t> moving;
    for (const float box_m : {0.0F, 0.0F, 5.0F, 5.0F, 5.0F, 0.0F, 0.0F}) {
      const auto scan = std::move(pipeline.push(wall_and_box(box_m), Pose::Identity())[0]);
      moving.push_back(std::ranges::count(scan.labels, kMovingLabel));
      EXPECT_EQ(scan.judged, scan.scan_index >= 2);
    }
    EXPECT_GT(moving[2], 80);
    EXPECT_EQ(moving[3], moving[2]);
    moving[2] = moving[3] = 0;
    EXPECT_EQ(moving, std::vector<std::ptrdiff_t>(7));
  }
}

}  // namespace
}  // namespace mosbench::yoon
