#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos_plus/pipeline.hpp"
#include "tests/small_world.hpp"

namespace mosbench {
namespace {

hmm_mos_plus::Config plus_of_a_room(int delay_scans = 0) {
  hmm_mos_plus::Config config;
  config.map.voxel_size_m = 0.25;
  config.map.min_range_m = 0.3;
  config.map.max_range_m = 5.0;
  config.map.delay_scans = delay_scans;
  config.max_unknown_voxels = 60;  // few rays leave much unknown
  return config;
}

std::vector<std::vector<std::uint32_t>> plus_labels(
    const SmallWorld& world, const hmm_mos_plus::Config& config, unsigned threads = 1,
    const std::vector<std::int64_t>& stamps_ns = {}) {
  hmm_mos_plus::Pipeline pipeline(config, {.threads = threads, .stamps_ns = stamps_ns});
  std::vector<std::vector<std::uint32_t>> labels;
  for (LabelledScan& result : results_of(pipeline, world))
    labels.push_back(std::move(result.labels));
  return labels;
}

TEST(PlusInAStaticWorld, HasNoMovingPointForAStaticNoiselessSensor) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const SmallWorld world = small_world(
        {.seed = seed, .scans = 25, .moving_boxes = 0, .jitter_rad = 0.0, .walk_m = 0.0});
    for (const int delay : {0, 4})
      EXPECT_EQ(moving_points(plus_labels(world, plus_of_a_room(delay))), 0U);
  }
}

TEST(PlusThreads, ChangeNoLabel) {
  std::size_t moving = 0;
  for (unsigned seed = 20; seed < 24; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .defects = seed % 2 == 0});
    for (const int delay : {0, 3}) {
      const auto expected = plus_labels(world, plus_of_a_room(delay));
      moving += moving_points(expected);
      EXPECT_EQ(plus_labels(world, plus_of_a_room(delay), 3), expected);
    }
  }
  EXPECT_GT(moving, 500U);
}

/// Poses and points are multiples of 2^-10, so that sums and voxel corners are exact.
TEST(PlusShiftedByWholeVoxels, ChangesNoLabel) {
  std::size_t moving = 0;
  for (unsigned seed = 30; seed < 34; ++seed) {
    SmallWorld world = small_world({.seed = seed});
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      world.poses[k].linear().setIdentity();
      for (double& t : world.poses[k].translation()) t = std::round(t * 1024) / 1024;
      for (Point& p : world.scans[k]) {
        p = {std::round(p.x * 1024) / 1024, std::round(p.y * 1024) / 1024,
             std::round(p.z * 1024) / 1024, 0.0F};
      }
    }
    const auto expected = plus_labels(world, plus_of_a_room());
    moving += moving_points(expected);
    for (const Eigen::Vector3d& voxels :
         {Eigen::Vector3d{8, 16, -24}, Eigen::Vector3d{1, -3, 5}, Eigen::Vector3d{-1001, 7, -13}}) {
      SmallWorld moved = world;
      for (Pose& pose : moved.poses) pose.translation() += voxels * 0.25;
      ASSERT_EQ(plus_labels(moved, plus_of_a_room()), expected);
    }
  }
  EXPECT_GT(moving, 500U);
}

TEST(PlusWithoutSeeds, HasNoMovingPoint) {
  const SmallWorld world = small_world({.seed = 40});
  ASSERT_GT(moving_points(plus_labels(world, plus_of_a_room())), 50U);
  hmm_mos_plus::Config config = plus_of_a_room();
  config.max_unknown_voxels = 0;
  config.seed_age_s = 0;
  config.min_seeds_voxels = config.min_pure_seeds_voxels = 100000;
  EXPECT_EQ(moving_points(plus_labels(world, config)), 0U);
}

/// A wall, and a box before it from the tenth scan on.
SmallWorld world_with_a_box_that_stays() {
  return world_ahead(30, [](std::size_t k, float y, float z) {
    return k >= 10 && std::abs(y) < 0.15F && std::abs(z) < 0.15F ? 2.0F : 4.0F;
  });
}

std::size_t scans_with_motion(const std::vector<std::vector<std::uint32_t>>& labels) {
  return static_cast<std::size_t>(std::ranges::count_if(
      labels, [](const auto& of_scan) { return std::ranges::count(of_scan, kMovingLabel) > 0; }));
}

TEST(PlusObjectsThatStay, MoveAsLongAsTheirSeedsAreFresh) {
  const SmallWorld world = world_with_a_box_that_stays();
  hmm_mos_plus::Config config = plus_of_a_room();
  config.max_aged_share = 1.0;
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 3U);
  config.fresh_age_s = 0.5;
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 6U);
  config.min_fresh_share = 0.0;
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 16U);
}

TEST(PlusObjectsThatStay, MayBeAgedWhereMostOfTheirVoxelsAreSeeds) {
  hmm_mos_plus::Config config = plus_of_a_room();
  config.min_fresh_share = 0.0;
  config.max_aged_share = 0.0;
  EXPECT_EQ(scans_with_motion(plus_labels(world_with_a_box_that_stays(), config)), 16U);
}

/// What `mosbench run --moving ever:SECONDS` sets.
TEST(PlusObjectsThatStay, MoveForAsLongAsMotionIsRemembered) {
  const SmallWorld world = world_with_a_box_that_stays();
  for (const auto& [kept_s, scans] : {std::pair{0.5, 6U}, {1.5, 16U}, {10.0, 20U}}) {
    hmm_mos_plus::Config config = plus_of_a_room();
    config.seed_age_s = config.object_age_s = config.fresh_age_s = kept_s;
    config.max_aged_share = 1.0;
    EXPECT_EQ(scans_with_motion(plus_labels(world, config)), scans) << kept_s;
  }
}

/// A wall, and before it a pole: in its place (A), beside it by a voxel (B) or not there (-), scan
/// by scan.
SmallWorld world_with_a_pole(std::string_view places) {
  return world_ahead(places.size(), [&](std::size_t k, float y, float) {
    const float pole_m = places[k] == 'A' ? 0.12F : 0.37F;
    return places[k] != '-' && std::abs(2.0F * y - pole_m) < 0.06F ? 2.0F : 4.0F;
  });
}

TEST(PlusPoles, MoveWhenTheyComeAndNotWhenPosesMoveThem) {
  const auto moving_scans = [](std::string_view places) {
    return scans_with_motion(plus_labels(world_with_a_pole(places), plus_of_a_room()));
  };
  EXPECT_GT(moving_scans("----AAAAAAAAAA"), 0U) << "comes";
  EXPECT_EQ(moving_scans("AAAA-----AAAAAA"), 0U) << "is missed for half a second";
  EXPECT_GT(moving_scans("AAAA------------AAAAAA"), 0U) << "and for more than a second";
  EXPECT_EQ(moving_scans("AAAA--BBBBBBBB"), 0U) << "is missed, and back a voxel aside";
  EXPECT_GT(moving_scans("AAAA--------BBBBBBBB"), 0U) << "so late that it is another";
}

TEST(PlusObjectsThatLeave, AreFoundOnlineByWhatDeparted) {
  const SmallWorld world = world_with_a_box_that_leaves();
  hmm_mos_plus::Config config = plus_of_a_room();
  const auto labels = plus_labels(world, config);
  EXPECT_GE(scans_with_motion(labels), 2U);
  EXPECT_EQ(scans_with_motion({labels.begin(), labels.begin() + 11}), 0U);
  config.min_track_steps = 0;
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 0U);
}

/// A level bar before a wall until the tenth scan, one voxel high or two.
TEST(PlusObjectsThatLeave, AreEdgesBetweenTwoBeamsWhereTheyAreSeenToBeFlat) {
  const auto departed_scans = [](float low_m) {
    const SmallWorld world = world_ahead(20, [&](std::size_t k, float y, float z) {
      const bool is_bar = std::abs(2.0F * y) < 0.9F && 2.0F * z > low_m && 2.0F * z < 0.22F;
      return k < 10 && is_bar ? 2.0F : 4.0F;
    });
    return scans_with_motion(plus_labels(world, plus_of_a_room(3)));
  };
  EXPECT_EQ(departed_scans(0.03F), 0U);
  EXPECT_GT(departed_scans(-0.22F), 0U);
}

TEST(PlusDelays, AreSaidToBeLongBeyondFifteenScans) {
  EXPECT_THAT(hmm_mos_plus::Pipeline(plus_of_a_room(15), {}).remarks(), testing::IsEmpty());
  EXPECT_THAT(hmm_mos_plus::Pipeline(plus_of_a_room(16), {}).remarks(),
              testing::ElementsAre(testing::HasSubstr("a delay of 16 scans costs precision")));
  // So they are of hmm-mos, which also says how the end is labelled where that is known.
  hmm_mos::Config map = plus_of_a_room(15).map;
  EXPECT_THAT(hmm_mos::Pipeline(map).remarks(), testing::IsEmpty());
  map.delay_scans = 16;
  EXPECT_THAT(hmm_mos::Pipeline(map, {.scan_count = 20}).remarks(),
              testing::ElementsAre(testing::HasSubstr("--set delay=all judges whole tracks"),
                                   testing::HasSubstr("the last 16 scans have no 16 later ones")));
}

/// Returns the stamps of `scans` scans.
std::vector<std::int64_t> stamps_every(std::int64_t period_ns, std::size_t scans) {
  std::vector<std::int64_t> stamps_ns = {1'700'000'000'000'000'000};
  while (stamps_ns.size() < scans) stamps_ns.push_back(stamps_ns.back() + period_ns);
  return stamps_ns;
}

TEST(PlusStamps, ChangeNoLabelAtTenHertzWhateverTheirJitter) {
  std::size_t moving = 0;
  for (unsigned seed = 70; seed < 73; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    const auto expected = plus_labels(world, plus_of_a_room());
    moving += moving_points(expected);
    for (const std::int64_t period_ns : {98'000'000, 100'000'000, 103'700'000}) {
      std::vector<std::int64_t> stamps_ns = stamps_every(period_ns, world.scans.size());
      for (std::size_t k = 0; k < stamps_ns.size(); k += 3) stamps_ns[k] += 20'000'000;
      ASSERT_EQ(plus_labels(world, plus_of_a_room(), 1, stamps_ns), expected) << period_ns;
    }
  }
  EXPECT_GT(moving, 200U);
}

/// The box comes at the tenth of 30 scans of 10 Hz.
TEST(PlusStamps, LetABoxThatStaysMoveForLikeTimesAtEveryRate) {
  const SmallWorld world = world_with_a_box_that_stays();
  hmm_mos_plus::Config config = plus_of_a_room();
  config.fresh_age_s = 0.6;
  config.max_aged_share = 1.0;
  const auto moving_s = [&](std::size_t every, std::size_t times) {
    SmallWorld at_rate;
    for (std::size_t k = 0; k < world.scans.size(); k += every) {
      for (std::size_t i = 0; i < times; ++i) {
        at_rate.scans.push_back(world.scans[k]);
        at_rate.poses.push_back(world.poses[k]);
      }
    }
    const std::size_t period_ns = 100'000'000 * every / times;
    const auto stamps_ns = stamps_every(static_cast<std::int64_t>(period_ns), at_rate.scans.size());
    const auto scans = scans_with_motion(plus_labels(at_rate, config, 1, stamps_ns));
    return static_cast<double>(scans) * static_cast<double>(period_ns) * 1e-9;
  };
  EXPECT_NEAR(moving_s(1, 1), 0.7, 1e-9);
  EXPECT_NEAR(moving_s(2, 1), 0.8, 1e-9);
  EXPECT_NEAR(moving_s(1, 2), 0.7, 1e-9);
}

TEST(PlusStamps, CountScansThatAreMissing) {
  SmallWorld world = world_with_a_box_that_stays();
  std::vector<std::int64_t> stamps_ns = stamps_every(100'000'000, world.scans.size());
  hmm_mos_plus::Config config = plus_of_a_room();
  config.fresh_age_s = 0.6;
  config.max_aged_share = 1.0;
  for (int lost = 0; lost < 4; ++lost) {
    world.scans.erase(world.scans.begin() + 12);
    world.poses.erase(world.poses.begin() + 12);
    stamps_ns.erase(stamps_ns.begin() + 12);
  }
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 7U);
  EXPECT_EQ(scans_with_motion(plus_labels(world, config, 1, stamps_ns)), 3U);
}

/// A wall seen by rows of beams, and from the tenth scan on a box before it, where so many voxels
/// lie from row to row.
SmallWorld world_seen_in_rows(int rows_apart, float box_m) {
  SmallWorld world;
  for (std::size_t k = 0; k < 14; ++k) {
    std::vector<Point>& scan = world.scans.emplace_back();
    world.poses.push_back(Pose::Identity());
    for (float y = -0.4F; y < 0.4F; y += 0.02F) {
      for (int row = -12 / rows_apart; row <= 12 / rows_apart; ++row) {
        const float z = (0.125F + 0.5F * static_cast<float>(rows_apart * row)) / 4.1F;
        const bool hits = k >= 10 && std::abs(2 * y) < box_m / 2 && std::abs(2 * z) < box_m / 2;
        const float x = hits ? 2.1F : 4.1F;
        scan.push_back({x, x * y, x * z, 0.0F});
      }
    }
  }
  return world;
}

TEST(PlusBetweenRowsOfBeams, HasSeedsWhereTheGapsAreNoLonger) {
  for (const int unknown_between : {1, 2, 3}) {
    const SmallWorld world = world_seen_in_rows(unknown_between + 1, 1.0F);
    hmm_mos_plus::Config config = plus_of_a_room();
    config.max_unknown_voxels = 30;
    config.max_gap_voxels = unknown_between;
    EXPECT_GT(moving_points(plus_labels(world, config)), 0U) << unknown_between;
    config.max_gap_voxels = 0;
    EXPECT_EQ(moving_points(plus_labels(world, config)), 0U) << unknown_between;
  }
}

TEST(PlusObjectsOfFewVoxels, MoveWhenFewPureSeedsAreEnough) {
  const SmallWorld world = world_seen_in_rows(1, 0.6F);
  hmm_mos_plus::Config config = plus_of_a_room();
  config.min_seeds_voxels = 100;
  EXPECT_GT(moving_points(plus_labels(world, config)), 0U);
  config.min_pure_seeds_voxels = 100;
  EXPECT_EQ(moving_points(plus_labels(world, config)), 0U);
}

/// A floor and a wall; from the tenth scan on a box stands on the floor, four voxels high.
SmallWorld world_with_a_box_on_a_floor() {
  SmallWorld world;
  for (std::size_t k = 0; k < 20; ++k) {
    std::vector<Point>& scan = world.scans.emplace_back();
    world.poses.push_back(Pose::Identity());
    for (float y = -0.5F; y < 0.5F; y += 0.02F) {
      for (float down = -0.2F; down < 0.6F; down += 0.01F) {
        const bool hits = k >= 10 && 2.0F * down > 0.1F && 2.0F * down < 0.9F && std::abs(y) < 0.2F;
        const float x = hits ? 2.0F : std::min(4.0F, 0.9F / std::max(down, 0.01F));
        scan.push_back({x, y * x, -down * x, 0.0F});
      }
    }
  }
  return world;
}

TEST(PlusOnTheGround, MovesWhatRisesFromItAlone) {
  const SmallWorld world = world_with_a_box_on_a_floor();
  hmm_mos_plus::Config config = plus_of_a_room();
  EXPECT_GT(scans_with_motion(plus_labels(world, config)), 0U);
  config.min_rise_voxels = 3;
  EXPECT_GT(scans_with_motion(plus_labels(world, config)), 0U) << "z is -4 to -1 voxels";
  config.min_rise_voxels = 4;
  EXPECT_EQ(scans_with_motion(plus_labels(world, config)), 0U);
}

TEST(PlusScores, AreAtTheThresholdOrAboveWhereAPointMovesButForFeet) {
  hmm_mos_plus::Config config = plus_of_a_room();
  config.ground_layers_voxels = 0;
  std::size_t moving = 0, below = 0;
  for (unsigned seed = 50; seed < 54; ++seed) {
    hmm_mos_plus::Pipeline pipeline(config, {.scores = true});
    for (const LabelledScan& scan : results_of(pipeline, small_world({.seed = seed}))) {
      ASSERT_EQ(scan.scores.size(), scan.labels.size());
      ASSERT_EQ(scan.threshold, config.min_seed_share);
      for (std::size_t i = 0; i < scan.labels.size(); ++i) {
        ASSERT_GE(scan.scores[i], 0.0F);
        ASSERT_LE(scan.scores[i], 1.0F);
        if (scan.labels[i] != kMovingLabel) continue;
        ++moving;
        below += scan.scores[i] < static_cast<float>(config.min_seed_share);
      }
    }
  }
  EXPECT_GT(moving, 200U);
  EXPECT_LT(below * 2, moving);
}

TEST(PlusReasons, AreOfEveryMovingPointOneDepartedWithADelayAndPredictedWithout) {
  std::array<std::size_t, kReasonCount> points{};
  for (unsigned seed = 50; seed < 54; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    for (const int delay : {0, 3}) {
      hmm_mos_plus::Pipeline pipeline(plus_of_a_room(delay), {.scores = true});
      const std::vector<LabelledScan> results = results_of(pipeline, world);
      const auto plain = plus_labels(world, plus_of_a_room(delay));
      for (std::size_t k = 0; k < results.size(); ++k) {
        ASSERT_EQ(results[k].labels, plain[k]);
        ASSERT_EQ(results[k].reasons.size(), plain[k].size());
        for (std::size_t i = 0; i < plain[k].size(); ++i) {
          const Reason reason = results[k].reasons[i];
          ASSERT_EQ(reason != Reason::kNone, plain[k][i] == kMovingLabel);
          ASSERT_NE(reason, delay > 0 ? Reason::kPredicted : Reason::kDeparted);
          ++points.at(static_cast<std::size_t>(reason));
        }
      }
    }
  }
  points.at(static_cast<std::size_t>(Reason::kPredicted)) += 21;  // PlusPrediction has more of them
  for (const std::size_t of_reason : points) EXPECT_GT(of_reason, 20U);
}

/// The box leaves in scan 10. Scans 10 and 11 are looked back at from 12 and 13.
TEST(PlusPrediction, NeedsTwoScansOfMotion) {
  hmm_mos_plus::Pipeline pipeline(plus_of_a_room(), {.scores = true});
  std::size_t predicted = 0;
  for (const LabelledScan& scan : results_of(pipeline, world_with_a_box_that_leaves())) {
    const auto here = std::ranges::count(scan.reasons, Reason::kPredicted);
    ASSERT_TRUE(here == 0 || scan.scan_index >= 13) << scan.scan_index;
    predicted += static_cast<std::size_t>(here);
  }
  EXPECT_GT(predicted, 50U);
}

TEST(PlusPrediction, IsNotThereWhenTurnedOffAndWithADelay) {
  hmm_mos_plus::Config off = plus_of_a_room(), late = plus_of_a_room(2);
  off.min_track_steps = 0;
  std::size_t changed = 0;
  for (unsigned seed = 80; seed < 84; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    hmm_mos_plus::Pipeline pipeline(off, {.scores = true});
    for (const LabelledScan& scan : results_of(pipeline, world)) {
      ASSERT_EQ(std::ranges::count(scan.reasons, Reason::kPredicted), 0);
    }
    changed += plus_labels(world, off) != plus_labels(world, plus_of_a_room());
    late.min_track_steps = 1;
    const auto expected = plus_labels(world, late);
    late.min_track_steps = 0;
    ASSERT_EQ(plus_labels(world, late), expected);
  }
  EXPECT_GT(changed, 0U);
}

TEST(PlusMemory, StaysBoundedOverALongRun) {
  SmallWorld world = small_world({.seed = 60, .scans = 30});
  hmm_mos_plus::Pipeline pipeline(plus_of_a_room(2), {});
  std::size_t early_bytes = 0;
  for (std::size_t k = 0; k < 400; ++k) {
    pipeline.push(world.scans[k % 30], world.poses[k % 30]);
    if (k == 60) early_bytes = pipeline.memory()->bytes;
  }
  ASSERT_GT(early_bytes, 100'000U);
  EXPECT_LT(pipeline.memory()->bytes, early_bytes + early_bytes / 2);
}

}  // namespace
}  // namespace mosbench
