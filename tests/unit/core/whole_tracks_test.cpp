#include "core/tracks/whole_tracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <vector>

#include "tests/track_scenes.hpp"

namespace mosbench::tracks {
namespace {

constexpr WholeTracksConfig kConfig{60, 0.5, 30};

/// The labels of a scene, and how many points of each thing they call moving.
struct Judged {
  std::vector<std::vector<std::uint32_t>> labels;
  std::vector<double> share;    ///< by thing
  std::size_t rest_moving = 0;  ///< points of the ground and the walls
};

/// Whether a method proposes points of a thing in a scan.
using Proposes = bool (*)(int scan, int thing);

Judged judge(const TrackScene& scene, Proposes proposes, unsigned threads = 1) {
  std::vector<SceneScan> scans;
  auto told = std::make_unique<ToldMethod>();
  for (int k = 0; k < scene.scans; ++k) {
    scans.push_back(cast(scene, k));
    std::vector<std::uint32_t>& labels = told->labels.emplace_back();
    for (const int thing : scans.back().thing) {
      labels.push_back(thing >= 0 && proposes(k, thing) ? kMovingLabel : kStaticLabel);
    }
  }
  WholeTracks method(kConfig, std::move(told), {.threads = threads});
  Judged judged;
  const auto take = [&](const std::vector<LabelledScan>& labelled) {
    for (const LabelledScan& scan : labelled) {
      EXPECT_EQ(scan.scan_index, judged.labels.size());
      judged.labels.push_back(scan.labels);
    }
  };
  for (const SceneScan& scan : scans) take(method.push(scan.points, scan.map_from_sensor));
  take(method.finish());
  std::vector<double> points(scene.things.size()), moving(scene.things.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    for (std::size_t i = 0; i < scans[k].thing.size(); ++i) {
      const bool moves = judged.labels.at(k).at(i) == kMovingLabel;
      const int thing = scans[k].thing[i];
      if (thing < 0) {
        judged.rest_moving += moves ? 1 : 0;
      } else {
        points[static_cast<std::size_t>(thing)] += 1;
        moving[static_cast<std::size_t>(thing)] += moves ? 1 : 0;
      }
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) judged.share.push_back(moving[i] / points[i]);
  return judged;
}

bool nothing(int, int) { return false; }
bool everything(int, int) { return true; }

const Walker kPasser{person(6, -3), {0, 1.2, 0}};

TEST(WholeTracks, FindAWalkerWhomNobodyProposed) {
  const Judged judged = judge({.things = {kPasser}}, nothing);
  EXPECT_GT(judged.share[0], 0.85) << "all above 0.2 m";
  EXPECT_EQ(judged.rest_moving, 0U);
}

TEST(WholeTracks, CompleteAWalkerFromItsFirstToItsLastScan) {
  const Judged judged =
      judge({.things = {kPasser}}, [](int scan, int) { return scan > 20 && scan < 40; });
  EXPECT_GT(judged.share[0], 0.9);
}

TEST(WholeTracks, KnowAParkedCarThatComesIntoView) {
  const TrackScene scene{
      .things = {{{{8, 3, 0.2}, {12, 4.8, 1.6}}}, {{{5, 2, 0.1}, {6, 2.3, 2.5}}}},
      .sensor_velocity_m_s = {1.5, 0, 0}};
  const Judged judged = judge(scene, [](int scan, int) { return scan > 5 && scan < 20; });
  EXPECT_LT(judged.share[0], 0.01);
  EXPECT_LT(judged.share[1], 0.01);
  EXPECT_EQ(judged.rest_moving, 0U);
}

TEST(WholeTracks, LeaveAPoleBesideAWalkerStatic) {
  const TrackScene scene{.things = {kPasser, {{{6.6, 0, 0}, {6.7, 0.1, 3}}}}};
  const Judged judged = judge(scene, everything);
  EXPECT_GT(judged.share[0], 0.9);
  EXPECT_LT(judged.share[1], 0.2);
}

TEST(WholeTracks, FindTwoWhoCross) {
  const TrackScene scene{.things = {kPasser, {person(8, 3), {0, -1.2, 0}}}};
  const Judged judged = judge(scene, nothing);
  EXPECT_GT(judged.share[0], 0.85);
  EXPECT_GT(judged.share[1], 0.8) << "the one in front hides the other";
}

TEST(WholeTracks, NumberAnObjectAlikeInAllScans) {
  const TrackScene scene{.things = {kPasser, {person(12, -9), {0, 0.8, 0}}}};
  auto told = std::make_unique<ToldMethod>();
  std::vector<SceneScan> scans;
  for (int k = 0; k < scene.scans; ++k) {
    scans.push_back(cast(scene, k));
    told->labels.emplace_back(scans.back().points.size(), kStaticLabel);
  }
  WholeTracks method(kConfig, std::move(told), {.scores = true});
  std::vector<LabelledScan> labelled;
  for (const SceneScan& scan : scans) {
    std::ranges::move(method.push(scan.points, scan.map_from_sensor), std::back_inserter(labelled));
  }
  std::ranges::move(method.finish(), std::back_inserter(labelled));
  std::set<std::uint32_t> numbers[2];
  for (std::size_t k = 0; k < labelled.size(); ++k) {
    ASSERT_EQ(labelled[k].objects.size(), scans[k].thing.size());
    for (std::size_t i = 0; i < scans[k].thing.size(); ++i) {
      if (labelled[k].labels[i] == kMovingLabel) {
        EXPECT_GT(labelled[k].objects[i], 0U) << "what moves is of a track";
        if (scans[k].thing[i] >= 0) numbers[scans[k].thing[i]].insert(labelled[k].objects[i]);
      }
    }
  }
  EXPECT_EQ(numbers[0].size(), 1U);
  ASSERT_FALSE(numbers[1].empty());
  EXPECT_FALSE(numbers[1].contains(*numbers[0].begin())) << "they never meet";
}

TEST(WholeTracks, DoNotDependOnThreads) {
  const TrackScene scene{.things = {kPasser, {person(8, 3), {0, -1.2, 0}}}, .scans = 40};
  EXPECT_EQ(judge(scene, everything, 1).labels, judge(scene, everything, 3).labels);
}

TEST(WholeTracks, HoldNoMoreThanTheirWindow) {
  // A point that goes back and forth for ever, in a window of 8 s.
  auto told = std::make_unique<ToldMethod>();
  for (int k = 0; k < 400; ++k) told->labels.push_back({kMovingLabel, kStaticLabel});
  WholeTracks method({8, 0.5, 30}, std::move(told), {});
  std::size_t most = 0, labelled = 0;
  for (int k = 0; k < 400; ++k) {
    const float y = k % 20 < 10 ? 0.3F : -0.3F;
    const std::vector<Point> points = {{5, y, 0, 0}, {20, -4 * y, 0, 0}};
    for (const LabelledScan& scan : method.push(points, Pose::Identity())) {
      EXPECT_EQ(scan.scan_index, labelled++);
    }
    most = std::max(most, method.held_scans());
  }
  EXPECT_EQ(most, 80U + 30U) << "the window, and the scans that look at its last one";
  EXPECT_EQ(labelled + method.finish().size(), 400U);
}

TEST(WholeTracks, LabelWhatHasEndedBeforeTheirWindow) {
  auto told = std::make_unique<ToldMethod>();
  for (int k = 0; k < 100; ++k) told->labels.push_back({kStaticLabel});
  WholeTracks method(kConfig, std::move(told), {});
  std::size_t most = 0;
  for (int k = 0; k < 100; ++k) {
    method.push(std::vector<Point>{{5, 0, 0, 0}}, Pose::Identity());
    most = std::max(most, method.held_scans());
  }
  EXPECT_LE(most, 62U) << "3 s that look ahead, 3 s that look back";
}

TEST(WholeTracks, KeepOfLookedAtScansOnlyTheirClusters) {
  constexpr std::size_t kPoints = 5000;
  auto told = std::make_unique<ToldMethod>();
  for (int k = 0; k < 160; ++k) told->labels.emplace_back(kPoints, kMovingLabel);
  WholeTracks method(kConfig, std::move(told), {});
  std::vector<Point> points(kPoints, {20, 0, 0, 0});
  std::size_t early = 0;
  for (int k = 0; k < 160; ++k) {
    // A point that keeps a track open, before and beside a wall.
    const float y = k % 20 < 10 ? 0.3F : -0.3F;
    points[0] = {5, y, 0, 0};
    points[1] = {20, -4 * y, 0, 0};
    method.push(points, Pose::Identity());
    if (k == 80) early = method.memory()->bytes;
  }
  EXPECT_EQ(method.held_scans(), 160U);
  EXPECT_LT(method.memory()->bytes, early + 80 * kPoints) << "not a byte per point";
}

/// A track of sightings with 10 points each, 0.1 s apart.
struct Path {
  int scans = 10;
  float step_m = 0;
  std::uint32_t through_before = 10, judged_before = 10, through_after = 10, judged_after = 10;
  std::uint32_t looks_through = 80;  ///< of 100
};

bool moves_along(const Path& path) {
  std::vector<Sighting> sightings;
  for (int k = 0; k < path.scans; ++k) {
    sightings.push_back({static_cast<std::uint32_t>(k),
                         {static_cast<float>(k) * path.step_m, 0},
                         {10, path.through_before, path.judged_before, path.through_after,
                          path.judged_after, path.looks_through, 100}});
  }
  return moves(sightings, 0.1);
}

TEST(TrackDecision, TakesWhatWentFarAndWasSeenThrough) {
  EXPECT_TRUE(moves_along({.step_m = 0.2F, .through_before = 2, .through_after = 2}));
  EXPECT_TRUE(moves_along({.step_m = 0.2F, .looks_through = 20}));
  EXPECT_FALSE(moves_along({.step_m = 0.2F, .through_before = 1, .through_after = 1}));
  EXPECT_FALSE(moves_along({.step_m = 0.02F}));
}

TEST(TrackDecision, TakesAWalkerInAHallByMoreLooks) {
  EXPECT_TRUE(moves_along({.step_m = 0.08F}));
  EXPECT_FALSE(moves_along({.step_m = 0.08F, .looks_through = 40}));
  EXPECT_FALSE(moves_along({.step_m = 0.08F, .through_before = 4, .through_after = 4}));
}

TEST(TrackDecision, RefusesWhatStandsOnOneSide) {
  EXPECT_FALSE(moves_along({.step_m = 0.2F, .through_after = 0}));
  EXPECT_FALSE(moves_along({.step_m = 0.2F, .through_before = 0}));
  EXPECT_TRUE(moves_along({.step_m = 0.2F, .through_before = 0, .judged_before = 2}));
  EXPECT_TRUE(moves_along({.scans = 60, .step_m = 0.2F, .through_before = 0})) << "a car ahead";
  EXPECT_FALSE(moves_along({.scans = 60, .step_m = 0.1F, .through_before = 0}));
}

TEST(TrackDecision, TakesWhatWasSeenShortly) {
  EXPECT_TRUE(moves_along({.scans = 4, .through_before = 3, .through_after = 3}));
  EXPECT_FALSE(moves_along({.scans = 4, .through_before = 2, .through_after = 2}));
  EXPECT_FALSE(moves_along({.scans = 5, .through_before = 4, .through_after = 4}));
  EXPECT_FALSE(moves_along({.scans = 0}));
}

TEST(ScanPeriod, IsTheMedianOfTheStamps) {
  EXPECT_EQ(ScanPeriod({}).scans(3), 30U);
  EXPECT_EQ(ScanPeriod({0, 200'000'000, 400'000'000, 1'000'000'000}).scans(3), 15U);
  EXPECT_EQ(ScanPeriod({0, 0, 0}).scans(3), 30U) << "no stamps";
}

}  // namespace
}  // namespace mosbench::tracks
