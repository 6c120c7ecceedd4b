#include "eval/breakdown/breakdown.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "eval/breakdown/run_diff.hpp"
#include "eval/breakdown/scan_breakdown.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ScanCluster cluster_at(double x_m, std::size_t points, std::size_t found,
                       std::uint32_t instance = 0) {
  ScanCluster cluster;
  cluster.instance = instance;
  cluster.points = points;
  cluster.found = found;
  cluster.centre_map_m = {x_m, 0.0, 0.0};
  cluster.range_m = x_m;
  return cluster;
}

TEST(ClusterPoints, JoinsTouchingCellsAndLeavesOutWhatHasNoPlace) {
  const std::vector<Eigen::Vector3d> points = {{0.1, 0.1, 0.1},  {5.0, 0.0, 0.0},
                                               {0.6, 0.6, 0.6},  {kNan, 0.0, 0.0},
                                               {-0.1, 0.1, 0.1}, {1e300, 0.0, 0.0}};
  EXPECT_THAT(cluster_points(points, 0.5), ElementsAre(ElementsAre(0, 2, 4), ElementsAre(1)));
  EXPECT_THAT(cluster_points({}, 0.5), testing::IsEmpty());
}

TEST(LinkObjects, FollowsTheNearestAndStartsAnewBeyondTheGate) {
  // One object walks, another appears 3 m away in scan 1 and comes back after a gap of 5 scans.
  const std::vector<ScanObjects> scans = {
      {0, 0.0, {cluster_at(0.0, 10, 0)}},
      {1, 0.1, {cluster_at(4.0, 10, 5), cluster_at(1.0, 10, 1)}},
      {2, 0.2, {cluster_at(2.0, 10, 10)}},
      {6, 0.6, {cluster_at(4.5, 10, 5)}}};
  const std::vector<ObjectTrack> tracks = link_objects(scans);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].sightings.size(), 3U);
  EXPECT_EQ(tracks[0].points(), 30U);
  EXPECT_EQ(tracks[0].found(), 11U);
  EXPECT_EQ(tracks[0].detection_delay_scans(), 1U);
  EXPECT_DOUBLE_EQ(tracks[0].speed_m_s().value(), 10.0);
  EXPECT_EQ(tracks[1].sightings.back().scan_index, 6U);
  EXPECT_EQ(tracks[1].detection_delay_scans(), 0U);
}

TEST(LinkObjects, TrustsInstancesAcrossAnyGap) {
  const std::vector<ScanObjects> scans = {
      {0, 0.0, {cluster_at(0.0, 10, 0, 7), cluster_at(0.5, 9, 0, 8)}},
      {50, 5.0, {cluster_at(90.0, 10, 0, 8), cluster_at(80.0, 5, 0, 7)}}};
  const std::vector<ObjectTrack> tracks = link_objects(scans);
  ASSERT_EQ(tracks.size(), 2U);
  for (const ObjectTrack& track : tracks) {
    ASSERT_EQ(track.sightings.size(), 2U);
    EXPECT_EQ(track.sightings[0].cluster.instance, track.sightings[1].cluster.instance);
    EXPECT_FALSE(track.detection_delay_scans());
  }
}

/// An object that goes 3 m/s there and back for two seconds each, its centre 0.5 m aside in every
/// second scan because part of it is hidden: from scan to scan it seems to go 2 or 8 m/s.
TEST(ObjectTrack, SpeedIsThatOfAboutASecondNotOfTheWholeWayOrOfAScan) {
  std::vector<ScanObjects> scans;
  for (std::size_t k = 0; k <= 40; ++k) {
    const double x_m = 0.3 * static_cast<double>(k <= 20 ? k : 40 - k);
    scans.push_back(
        {k, 0.1 * static_cast<double>(k), {cluster_at(x_m + (k % 2 == 0 ? 0.5 : 0.0), 10, 0)}});
  }
  const std::vector<ObjectTrack> tracks = link_objects(scans);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_NEAR(tracks[0].speed_m_s().value(), 3.0, 0.5 + 1e-9);
  // The same way in twice the time.
  for (ScanObjects& scan : scans) scan.time_s *= 2.0;
  EXPECT_NEAR(link_objects(scans)[0].speed_m_s().value(), 1.5, 0.5 + 1e-9);
  scans.resize(1);
  EXPECT_FALSE(link_objects(scans)[0].speed_m_s());
}

TEST(LinkObjects, DoesNotReachOverSixScans) {
  EXPECT_EQ(link_objects(std::vector<ScanObjects>{{0, 0.0, {cluster_at(0.0, 10, 0)}},
                                                  {6, 0.6, {cluster_at(0.0, 10, 0)}}})
                .size(),
            2U);
}

/// Eight points: two objects and a false positive.
Frame small_frame() {
  Frame frame;
  frame.points = {{3, 0, 0, 0},  {3.1F, 0, 0, 0},  {15, 0, 1.2F, 0}, {15.1F, 0, 1.2F, 0},
                  {0, 25, 0, 0}, {0, 25.1F, 0, 0}, {0, 26, 0, 0},    {0, 0, 60, 0}};
  frame.truth = std::vector<std::uint32_t>{251, 251, 251, 251, 9, 9, 9, 0};
  frame.map_from_sensor.translation() = Eigen::Vector3d(100.0, 0.0, 5.0);
  return frame;
}
const std::vector<std::uint32_t> kPrediction = {251, 9, 251, 251, 251, 251, 9, 251};

TEST(BreakDownScan, SortsPointsByRangeHeightAndThing) {
  const Protocol& protocol = protocol_named("semantickitti-mos");
  const ScanBreakdown breakdown =
      break_down_scan(protocol, protocol.default_range, small_frame(), kPrediction);
  EXPECT_EQ(breakdown.by_range[0].tp, 1U);
  EXPECT_EQ(breakdown.by_range[0].fn, 1U);
  EXPECT_EQ(breakdown.by_range[2].tp, 2U);
  EXPECT_EQ(breakdown.by_range[3].fp, 2U);
  EXPECT_EQ(breakdown.by_range[3].tn, 1U);
  EXPECT_EQ(breakdown.by_range[6].ignored, 1U);
  EXPECT_EQ(breakdown.by_height[7].tp, 2U) << "1 to 2 m above the sensor";
  ASSERT_EQ(breakdown.objects.size(), 2U);
  EXPECT_EQ(breakdown.objects[0].found + breakdown.objects[1].found, 3U);
  EXPECT_NEAR(breakdown.objects[0].centre_map_m.x(), 103.05, 1e-6);
  ASSERT_EQ(breakdown.false_positives.size(), 1U);
  EXPECT_EQ(breakdown.false_positives[0].points, 2U);
  EXPECT_NEAR(breakdown.false_positives[0].range_m, 25.05, 1e-6);
}

TEST(BreakDownScan, AddsUpToTheScore) {
  const Protocol& protocol = protocol_named("doals-hmm");
  const Frame frame = small_frame();
  const ScanBreakdown breakdown = break_down_scan(protocol, {0.5, 20.0}, frame, kPrediction);
  Confusion by_range;
  Confusion by_height;
  for (const Confusion& bin : breakdown.by_range) by_range += bin;
  for (const Confusion& bin : breakdown.by_height) by_height += bin;
  const Confusion whole =
      score_scan(protocol, *frame.truth, kPrediction, frame.points, {0.5, 20.0});
  EXPECT_EQ(by_range, whole);
  EXPECT_EQ(by_height, whole);
}

TEST(RecallBins, CountObjectsBySpeedAndSightingsByAge) {
  const std::vector<ObjectTrack> tracks = link_objects(std::vector<ScanObjects>{
      {0, 0.0, {cluster_at(0.0, 10, 0)}}, {1, 0.1, {cluster_at(0.3, 10, 5)}}});
  EXPECT_EQ(recall_by_speed(tracks)[3].name, "2 to 5 m/s");
  EXPECT_EQ(recall_by_speed(tracks)[3].count, 1U);
  EXPECT_EQ(recall_by_speed(tracks)[3].tp, 5U);
  EXPECT_EQ(recall_by_age(tracks)[0].fn, 10U);
  EXPECT_EQ(recall_by_age(tracks)[1].tp, 5U);
  EXPECT_EQ(recall_by_size(tracks)[0].fn, 15U);
}

TEST(RunDiff, ListsTheObjectsFoundToDifferentParts) {
  SequenceBreakdown first;
  first.sequence = "room";
  first.stems = {"000000", "000001"};
  SequenceBreakdown second = first;
  first.objects = link_objects(
      std::vector<ScanObjects>{{0, 0.0, {cluster_at(0.0, 10, 1), cluster_at(9.0, 10, 4)}},
                               {1, 0.1, {cluster_at(9.5, 10, 4)}}});
  second.objects = link_objects(
      std::vector<ScanObjects>{{0, 0.0, {cluster_at(0.0, 10, 1), cluster_at(9.0, 10, 4)}},
                               {1, 0.1, {cluster_at(9.5, 10, 9)}}});
  const auto objects = disagreeing_objects(first, second);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].first_found, 8U);
  EXPECT_EQ(objects[0].second_found, 13U);
  EXPECT_EQ(objects[0].last_scan, "000001");
}

}  // namespace
}  // namespace mosbench
