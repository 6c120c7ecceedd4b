#include <gtest/gtest.h>

#include <algorithm>

#include "core/methods/dufomap/pipeline.hpp"

namespace mosbench::dufomap {
namespace {

Config metre_voxels() {
  Config config;
  config.resolution_m = 1;
  config.sensor_noise_m = 0.5;
  config.min_range_m = 0.2;
  config.max_range_m = 20;
  return config;
}

/// A sensor in the middle of its voxel.
Pose in_the_middle() {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d::Constant(0.5);
  return pose;
}

/// The six walls of a room, one point per voxel: 4 m from the sensor.
std::vector<Point> room() {
  std::vector<Point> points;
  for (int a = -4; a <= 4; ++a) {
    for (int b = -4; b <= 4; ++b) {
      const auto x = static_cast<float>(a), y = static_cast<float>(b);
      for (const float wall : {-4.0F, 4.0F}) {
        points.push_back({wall, x, y, 0});
        points.push_back({x, wall, y, 0});
        points.push_back({x, y, wall, 0});
      }
    }
  }
  return points;
}

std::vector<LabelledScan> run(const Config& config, const std::vector<std::vector<Point>>& scans) {
  Pipeline pipeline(config);
  std::vector<LabelledScan> all;
  for (const std::vector<Point>& points : scans) {
    for (LabelledScan& scan : pipeline.push(points, in_the_middle())) all.push_back(scan);
  }
  for (LabelledScan& scan : pipeline.finish()) all.push_back(scan);
  return all;
}

TEST(Dufomap, FindsWhatArrivesInVoidSpaceAndKeepsThatForEver) {
  std::vector<Point> with_object = room();
  with_object.push_back({2, 0, 0, 0});
  const auto scans =
      run(metre_voxels(), {room(), with_object, with_object, with_object, with_object});
  ASSERT_EQ(scans.size(), 5U);
  EXPECT_FALSE(scans[0].judged);
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_EQ(scans[k].labels.back(), kMovingLabel) << "scan " << k;
    EXPECT_EQ(std::ranges::count(scans[k].labels, kMovingLabel), 1);
  }
}

TEST(Dufomap, FindsWhatLeavesOnlyAtTheEnd) {
  std::vector<Point> with_object = room();
  with_object.push_back({2, 0, 0, 0});
  Config config = metre_voxels();
  EXPECT_EQ(run(config, {with_object, room()})[0].labels.back(), kStaticLabel);
  config.when = When::kFinal;
  const auto scans = run(config, {with_object, room()});
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].labels.back(), kMovingLabel);
  EXPECT_TRUE(scans[0].judged);
}

TEST(Dufomap, TrustsNoSpaceWhoseNeighboursWereNotSeen) {
  // A lone ray: its neighbours are unknown, so nothing is void but with d_p = 0.
  const std::vector<std::vector<Point>> scans = {{{8, 0, 0, 0}}, {{3, 0, 0, 0}}};
  Config config = metre_voxels();
  EXPECT_EQ(run(config, scans)[1].labels[0], kStaticLabel);
  config.pose_error_voxels = 0;
  EXPECT_EQ(run(config, scans)[1].labels[0], kMovingLabel);
}

TEST(Dufomap, TakesTheLastPartOfARayForHit) {
  Config config = metre_voxels();
  config.pose_error_voxels = 0;
  const auto second = [&](float x) { return run(config, {{{8, 0, 0, 0}}, {{x, 0, 0, 0}}})[1]; };
  EXPECT_EQ(second(7).labels[0], kMovingLabel);
  config.sensor_noise_m = 1.2;  // back from the middle of voxel 8
  EXPECT_EQ(second(7).labels[0], kStaticLabel);
  EXPECT_EQ(second(6).labels[0], kMovingLabel);
}

TEST(Dufomap, CutsRaysAtTheRangeLimit) {
  Config config = metre_voxels();
  config.pose_error_voxels = 0;
  config.max_range_m = 5;
  const auto second = [&](float x) { return run(config, {{{15, 0, 0, 0}}, {{x, 0, 0, 0}}})[1]; };
  EXPECT_EQ(second(4).labels[0], kMovingLabel);
  EXPECT_EQ(second(7).labels[0], kStaticLabel);
}

TEST(Dufomap, LabelsNoPointBeyondTheRangeLimit) {
  Config config = metre_voxels();
  config.pose_error_voxels = 0;
  config.max_range_m = 5;
  // The same point in void space, from a sensor that stands farther away.
  const auto seen_from = [&](float back_m) {
    Pipeline pipeline(config);
    pipeline.push(std::vector<Point>{{15, 0, 0, 0}}, in_the_middle());
    Pose pose = in_the_middle();
    pose.translation().x() -= back_m;
    return pipeline.push(std::vector<Point>{{3 + back_m, 0, 0, 0}}, pose)[0].labels[0];
  };
  EXPECT_EQ(seen_from(1), kMovingLabel);
  EXPECT_EQ(seen_from(3), kStaticLabel);
}

TEST(Dufomap, RefusesARangeOfTooManyVoxels) {
  Config config;
  config.resolution_m = 0.01;
  EXPECT_THROW(check(config), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench::dufomap
