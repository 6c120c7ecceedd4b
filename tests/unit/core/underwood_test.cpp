#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/methods/underwood/pipeline.hpp"
#include "core/voxel/directions.hpp"

namespace mosbench::underwood {
namespace {

constexpr double kAlpha_rad = 0.0157;
constexpr float kRho_m = 0.15F;

/// Nine points around a direction, 0.01 rad apart, all at 10 m.
std::vector<Direction> nine_around(float bearing_rad) {
  std::vector<Direction> points;
  for (const float b : {-0.01F, 0.0F, 0.01F}) {
    for (const float e : {-0.01F, 0.0F, 0.01F}) {
      points.push_back({10, std::remainder(bearing_rad + b, 2 * std::numbers::pi_v<float>), e});
    }
  }
  return points;
}

bool is_changed(const std::vector<Direction>& reference, const Direction& query) {
  return DirectionGrid(reference, kAlpha_rad).free_margin_m(query, kRho_m) >= kRho_m;
}

TEST(UnderwoodQuery, IsChangedWhereAllNeighboursAreFartherByTheTolerance) {
  const std::vector<Direction> nine = nine_around(0);
  EXPECT_TRUE(is_changed(nine, {5, 0.002F, 0.002F}));
  EXPECT_TRUE(is_changed(nine, {9.84F, 0.002F, 0.002F}));
  EXPECT_FALSE(is_changed(nine, {9.86F, 0.002F, 0.002F}));
  EXPECT_FALSE(is_changed(nine, {12, 0.002F, 0.002F}));
}

TEST(UnderwoodQuery, IsNotChangedWhereOneNeighbourIsNearer) {
  std::vector<Direction> points = nine_around(0);
  ASSERT_TRUE(is_changed(points, {5, 0, 0}));
  for (Direction& point : points) {
    const float range_m = point.range_m;
    point.range_m = 4;
    EXPECT_FALSE(is_changed(points, {5, 0, 0}));
    point.range_m = range_m;
  }
}

TEST(UnderwoodQuery, IsUnknownOutsideTheBoxOfItsNeighboursAndWithoutAny) {
  EXPECT_FALSE(is_changed(nine_around(0), {5, 0.02F, 0.002F}));  // three lie to its right
  EXPECT_FALSE(is_changed(nine_around(0), {5, 0.002F, 0.02F}));
  EXPECT_FALSE(is_changed(nine_around(0), {5, 0.5F, 0}));
  EXPECT_FALSE(is_changed({}, {5, 0, 0}));
  const std::vector<Direction> row = {{10, -0.01F, 0}, {10, 0, 0}, {10, 0.01F, 0}};
  EXPECT_FALSE(is_changed(row, {5, 0, 0.001F}));
}

TEST(UnderwoodQuery, HasTheLowerEndOfBearingsInsideAndThatOfElevationsOutside) {
  const std::vector<Direction> cross = {{10, 0, 0.01F}, {10, 0, -0.01F}};
  EXPECT_TRUE(is_changed(cross, {5, 0, 0}));  // min b <= b <= max b
  const std::vector<Direction> level = {{10, 0.01F, 0}, {10, -0.01F, 0}};
  EXPECT_FALSE(is_changed(level, {5, 0, 0}));  // not min e < e
}

TEST(UnderwoodQuery, SeesNeighboursAcrossTheEndsOfTheBearings) {
  for (const float seam : {std::numbers::pi_v<float> - 0.005F, -std::numbers::pi_v<float> + 0.005F,
                           std::numbers::pi_v<float>, 0.0F}) {
    EXPECT_TRUE(is_changed(nine_around(seam), {5, seam, 0.002F})) << seam;
  }
}

TEST(UnderwoodQuery, GivesTheMarginOfTheNearestNeighbour) {
  std::vector<Direction> points = nine_around(0);
  points[4].range_m = 7;
  EXPECT_EQ(DirectionGrid(points, kAlpha_rad).free_margin_m({5, 0, 0}, 0), 2.0F);
  EXPECT_EQ(DirectionGrid(points, kAlpha_rad).free_margin_m({7.5F, 0, 0}, 0), 0.0F);
}

/// A wall of points 0.01 rad apart at a range.
std::vector<Point> wall(float range_m) {
  std::vector<Point> points;
  for (float b = -0.1F; b < 0.1F; b += 0.01F) {
    for (float e = -0.1F; e < 0.1F; e += 0.01F) {
      points.push_back({range_m * std::cos(e) * std::cos(b), range_m * std::cos(e) * std::sin(b),
                        range_m * std::sin(e), 0});
    }
  }
  return points;
}

/// The wall at 10 m with an object before it in scans 2 and 3.
std::vector<LabelledScan> run(const Config& config, std::size_t scans) {
  Pipeline pipeline(config);
  std::vector<LabelledScan> all;
  for (std::size_t k = 0; k < scans; ++k) {
    std::vector<Point> points = wall(10);
    if (k == 2 || k == 3) points.push_back({5, 0.01F, 0.01F, 0});
    for (LabelledScan& scan : pipeline.push(points, Pose::Identity())) all.push_back(scan);
  }
  for (LabelledScan& scan : pipeline.finish()) all.push_back(scan);
  return all;
}

TEST(Underwood, FindsWhatAppearedSinceTheReference) {
  Config config;
  config.reference_offset_scans = 2;
  const std::vector<LabelledScan> scans = run(config, 6);
  ASSERT_EQ(scans.size(), 6U);
  EXPECT_FALSE(scans[1].judged);
  EXPECT_TRUE(scans[2].judged);
  EXPECT_EQ(scans[2].labels.back(), kMovingLabel);
  EXPECT_EQ(scans[3].labels.back(), kMovingLabel);
  EXPECT_EQ(std::ranges::count(scans[2].labels, kMovingLabel), 1);
  EXPECT_EQ(std::ranges::count(scans[4].labels, kMovingLabel), 0);
  config.reference_offset_scans = 1;  // it was there already
  EXPECT_EQ(run(config, 6)[3].labels.back(), kStaticLabel);
}

TEST(Underwood, FindsWhatDisappearsWhenDelayed) {
  Config config;
  config.reference_offset_scans = 1;
  config.delay_scans = 2;
  const std::vector<LabelledScan> scans = run(config, 6);
  ASSERT_EQ(scans.size(), 6U);
  EXPECT_EQ(scans[3].labels.back(), kMovingLabel);  // gone in scan 5
  EXPECT_TRUE(scans[0].judged);                     // by scan 2
  config.min_votes = 2;
  EXPECT_EQ(run(config, 6)[3].labels.back(), kStaticLabel);
  EXPECT_EQ(run(config, 6)[2].labels.back(), kMovingLabel);  // not in scan 1, not in scan 4
}

TEST(Underwood, RefusesMoreVotesThanReferences) {
  Config config;
  config.min_votes = 2;
  EXPECT_THROW(check(config), std::invalid_argument);
  config.references = 2;
  EXPECT_NO_THROW(check(config));
  config.min_range_m = config.max_range_m;
  EXPECT_THROW(check(config), std::invalid_argument);
}

/// A full turn of rows so far apart, seen every degree.
std::vector<Point> turn_of_rows(int rows, double spacing_deg) {
  std::vector<Point> points;
  for (int row = 0; row < rows; ++row) {
    for (int azimuth = 0; azimuth < 360; ++azimuth) {
      const double e = (row - rows / 2) * spacing_deg / 180 * std::numbers::pi;
      const double b = (azimuth + 0.5) / 180 * std::numbers::pi;
      points.push_back({static_cast<float>(10 * std::cos(e) * std::cos(b)),
                        static_cast<float>(10 * std::cos(e) * std::sin(b)),
                        static_cast<float>(10 * std::sin(e)), 0});
    }
  }
  return points;
}

TEST(UnderwoodAngle, ReachesFromRowToRow) {
  const std::vector<Point> turn = turn_of_rows(16, 2.0);
  NeighbourAngle sparse(0.0157, 1.15);
  sparse.measure(std::span(turn).first(900), 0.5);
  EXPECT_EQ(sparse.rad(), 0.0157) << "too few returns to tell";
  EXPECT_TRUE(sparse.remarks().empty());
  sparse.measure(turn, 0.5);
  EXPECT_NEAR(sparse.rad(), 1.15 * 2.0 / 180 * std::numbers::pi, 1e-6);
  EXPECT_EQ(sparse.remarks().size(), 1U);
  const double first_rad = sparse.rad();
  sparse.measure(turn_of_rows(16, 3.0), 0.5);
  EXPECT_EQ(sparse.rad(), first_rad) << "measured once";
  NeighbourAngle dense(0.0157, 1.15);
  dense.measure(turn_of_rows(64, 0.5), 0.5);
  EXPECT_EQ(dense.rad(), 0.0157) << "reaches already";
  NeighbourAngle as_set(0.0157, 0);
  as_set.measure(turn, 0.5);
  EXPECT_EQ(as_set.rad(), 0.0157);
  NeighbourAngle widest(0.0157, 10);
  widest.measure(turn_of_rows(16, 8.0), 0.5);
  EXPECT_EQ(widest.rad(), kWidestAngle_rad);
}

/// A point between two rows of a sparse sensor, before a wall.
TEST(Underwood, FindsWhatCameBetweenRowsTwoDegreesApart) {
  for (const double least_angle_rows : {1.15, 0.0}) {
    Config config;
    config.reference_offset_scans = 1;
    config.least_angle_rows = least_angle_rows;
    Pipeline pipeline(config);
    std::vector<Point> points = turn_of_rows(16, 2.0);
    pipeline.push(points, Pose::Identity());
    points.push_back({5 * std::cos(0.01F), 0, 5 * std::sin(0.01F), 0});
    const LabelledScan scan = std::move(pipeline.push(points, Pose::Identity()).front());
    EXPECT_EQ(scan.labels.back() == kMovingLabel, least_angle_rows > 0);
    EXPECT_EQ(std::ranges::count(scan.labels, kMovingLabel), least_angle_rows > 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace mosbench::underwood
