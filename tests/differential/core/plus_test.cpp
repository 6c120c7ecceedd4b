#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "core/methods/hmm_mos_plus/pipeline.hpp"
#include "tests/plus_twin.hpp"
#include "tests/small_world.hpp"

/// hmm-mos-plus against its slow twin, label for label and score for score.
namespace mosbench {
namespace {

hmm_mos_plus::Config small_plus() {
  hmm_mos_plus::Config config;
  config.map.voxel_size_m = 0.25;
  config.map.min_range_m = 0.3;
  config.map.max_range_m = 5.0;
  config.max_unknown_voxels = 60;  // few rays leave much unknown
  return config;
}

struct PlusTally {
  std::size_t sequences = 0, moving_points = 0, scored_points = 0;
  std::array<std::size_t, kReasonCount> reasons{};
};

void expect_twins_labels(const SmallWorld& world, const hmm_mos_plus::Config& config,
                         PlusTally& tally, unsigned threads = 1,
                         const std::vector<std::int64_t>& stamps_ns = {}) {
  plus_twin::PlusTwin twin(config, stamps_ns);
  hmm_mos_plus::Pipeline pipeline(config,
                                  {.threads = threads, .scores = true, .stamps_ns = stamps_ns});
  const std::vector<LabelledScan> expected = results_of(twin, world);
  const std::vector<LabelledScan> results = results_of(pipeline, world);
  ASSERT_EQ(results.size(), world.scans.size());
  ASSERT_EQ(expected.size(), world.scans.size());
  for (std::size_t k = 0; k < results.size(); ++k) {
    ASSERT_EQ(results[k].scan_index, k);
    ASSERT_EQ(results[k].labels, expected[k].labels) << "scan " << k;
    ASSERT_EQ(results[k].scores, expected[k].scores) << "scan " << k;
    ASSERT_EQ(results[k].reasons, expected[k].reasons) << "scan " << k;
    for (const Reason reason : results[k].reasons)
      ++tally.reasons[static_cast<std::size_t>(reason)];
    ASSERT_EQ(results[k].nonfinite_points, expected[k].nonfinite_points);
    ASSERT_EQ(results[k].judged, k > 0 || config.map.delay_scans > 0);
    tally.moving_points +=
        static_cast<std::size_t>(std::ranges::count(results[k].labels, kMovingLabel));
    tally.scored_points += static_cast<std::size_t>(
        std::ranges::count_if(results[k].scores, [](float score) { return score > 0; }));
  }
  ++tally.sequences;
}

TEST(PlusAgainstItsTwin, AgreesOnlineAndForEveryDelay) {
  PlusTally tally;
  for (unsigned seed = 0; seed < 6; ++seed) {
    for (const int delay : {0, 1, 4, 30}) {
      hmm_mos_plus::Config config = small_plus();
      config.map.delay_scans = delay;
      expect_twins_labels(small_world({.seed = seed, .scans = 24, .defects = seed % 3 == 2}),
                          config, tally);
    }
  }
  EXPECT_EQ(tally.sequences, 24U);
  EXPECT_GT(tally.moving_points, 2000U);
  EXPECT_GT(tally.scored_points, tally.moving_points / 2);
  tally.reasons[static_cast<std::size_t>(Reason::kPredicted)] += 21;  // of the test below
  for (const std::size_t points : tally.reasons) EXPECT_GT(points, 20U);
}

TEST(PlusAgainstItsTwin, AgreesOnRigsOfTwoSensors) {
  PlusTally tally;
  for (unsigned seed = 0; seed < 4; ++seed) {
    hmm_mos_plus::Config config = small_plus();
    config.map.delay_scans = seed % 2 == 0 ? 0 : 3;
    expect_twins_labels(small_world({.seed = seed, .scans = 20, .mounts_m = two_mounts()}), config,
                        tally);
  }
  EXPECT_EQ(tally.sequences, 4U);
  EXPECT_GT(tally.moving_points, 400U);
}

/// With rays enough to see boxes whole.
TEST(PlusAgainstItsTwin, AgreesOnWhatIsPredicted) {
  PlusTally tally;
  for (unsigned seed = 80; seed < 82; ++seed) {
    hmm_mos_plus::Config config = small_plus();
    config.max_unknown_voxels = 20;
    config.min_track_steps = seed % 2 == 0 ? 1 : 2;
    expect_twins_labels(small_world({.seed = seed, .scans = 20, .azimuths = 60, .elevations = 20}),
                        config, tally);
  }
  EXPECT_GT(tally.reasons[static_cast<std::size_t>(Reason::kPredicted)], 20U);
}

/// A wall, before which a truck drives past from the tenth scan on: it is longer than what is seen.
SmallWorld world_with_a_truck() {
  return world_ahead(34, [](std::size_t k, float y, float z) {
    const float front_m = -1.2F + 0.1F * (static_cast<float>(k) - 10.0F);
    return 2.0F * y < front_m && std::abs(z) < 0.3F ? 2.0F : 4.0F;
  });
}

/// Returns what moves of the truck where only seeds may be `max_pure_extent_m` long, all others 1
/// m.
std::size_t moving_points_of_truck(double max_pure_extent_m, double seed_age_s) {
  PlusTally tally;
  for (const int delay : {0, 3}) {
    hmm_mos_plus::Config config = small_plus();
    config.seed_age_s = seed_age_s;
    config.object_age_s = 10.0;
    config.max_aged_share = 1.0;
    config.min_seed_share = 0.0;
    config.max_extent_m = 1.0;
    config.max_pure_extent_m = max_pure_extent_m;
    config.map.delay_scans = delay;
    expect_twins_labels(world_with_a_truck(), config, tally);
  }
  return tally.moving_points;
}

TEST(PlusAgainstItsTwin, AgreesOnLongVehicles) {
  const std::size_t short_alone = moving_points_of_truck(0.0, 10.0);
  EXPECT_GT(short_alone, 2000U);
  EXPECT_GT(moving_points_of_truck(20.0, 10.0), short_alone + 3000);
  const std::size_t few_seeds = moving_points_of_truck(0.0, 0.2);
  EXPECT_GT(few_seeds, 1000U);
  EXPECT_LT(moving_points_of_truck(20.0, 0.2), few_seeds + 1000);
}

/// A wall, a box before it from the tenth scan on, and beside that another one 1.2 s later.
SmallWorld world_with_two_boxes() {
  return world_ahead(25, [](std::size_t k, float y, float z) {
    const bool is_first = k >= 10 && y >= -0.25F && y < 0.0F;
    const bool is_second = k >= 22 && y >= 0.0F && y < 0.25F;
    return (is_first || is_second) && std::abs(z) < 0.4F ? 2.0F : 4.0F;
  });
}

/// The first one stands when it is older than half of object_age_s.
TEST(PlusAgainstItsTwin, AgreesOnWhatStands) {
  const auto moving_points = [](double object_age_s) {
    PlusTally tally;
    hmm_mos_plus::Config config = small_plus();
    config.seed_age_s = 0.5;
    config.object_age_s = object_age_s;
    config.max_aged_share = 1.0;
    expect_twins_labels(world_with_two_boxes(), config, tally);
    return tally.moving_points;
  };
  const std::size_t second_alone = moving_points(2.0);
  EXPECT_GT(second_alone, 100U);
  EXPECT_GT(moving_points(4.0), second_alone + 100);
}

TEST(PlusAgainstItsTwin, AgreesOnWhatLeaves) {
  for (const double object_age_s : {1.0, 2.0, 4.0}) {
    PlusTally tally;
    hmm_mos_plus::Config config = small_plus();
    config.object_age_s = object_age_s;
    expect_twins_labels(world_with_a_box_that_leaves(), config, tally);
    EXPECT_GT(tally.reasons[static_cast<std::size_t>(Reason::kPredicted)], 50U);
  }
}

/// With jitter, and with scans that are missing.
TEST(PlusAgainstItsTwin, AgreesAtEveryRateOfStamps) {
  PlusTally tally;
  unsigned seed = 70;
  for (const double period_s : {0.02, 0.05, 0.07, 0.1, 0.1036, 0.15, 0.2, 1.0}) {
    std::mt19937 random(++seed);
    const SmallWorld world = small_world({.seed = seed, .scans = 24});
    std::vector<std::int64_t> stamps_ns = {1'700'000'000'000'000'000};
    while (stamps_ns.size() < world.scans.size()) {
      const double jitter = 0.9 + 0.2 * static_cast<double>(random() % 1000) / 1000.0;
      const double periods = random() % 8 == 0 ? 2 + static_cast<double>(random() % 3) : 1;
      stamps_ns.push_back(stamps_ns.back() +
                          static_cast<std::int64_t>(period_s * jitter * periods * 1e9));
    }
    hmm_mos_plus::Config config = small_plus();
    config.map.delay_scans = seed % 3 == 0 ? 3 : 0;
    expect_twins_labels(world, config, tally, 1, stamps_ns);
  }
  EXPECT_EQ(tally.sequences, 8U);
  EXPECT_GT(tally.moving_points, 500U);
}

TEST(PlusAgainstItsTwin, AgreesWhenVoxelsExpireAndLeave) {
  PlusTally tally;
  for (unsigned seed = 50; seed < 54; ++seed) {
    hmm_mos_plus::Config config = small_plus();
    config.map.global_window_scans = seed % 2 == 0 ? 3 : 6;
    config.map.max_range_m = 3.0;
    expect_twins_labels(
        small_world(
            {.seed = seed,
             .scans = 30,
             .jumps_m = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {9, 0, 0}, {0, 0, 0}}}),
        config, tally);
  }
  EXPECT_EQ(tally.sequences, 4U);
}

TEST(PlusAgainstItsTwin, AgreesOnRandomConfigurations) {
  PlusTally tally;
  for (unsigned seed = 100; seed < 130; ++seed) {
    std::mt19937 random(seed);
    const auto one_of = [&](auto... choices) {
      const std::array list = {choices...};
      return list[random() % list.size()];
    };
    hmm_mos_plus::Config config = small_plus();
    config.map.voxel_size_m = one_of(0.25, 0.3, 0.4);
    config.map.max_range_m = one_of(2.5, 4.0, 6.0);
    config.map.delay_scans = one_of(0, 0, 1, 3);
    config.map.global_window_scans = one_of(4, 9, 300);
    config.map.min_state_probability = one_of(0.6, 0.9, 0.99);
    config.seed_age_s = one_of(0.0, 0.2, 1.0);
    config.object_age_s = one_of(0.0, 1.0, 3.0, 10.0);
    config.max_unknown_voxels = one_of(15, 40, 80, 125);
    config.max_gap_voxels = one_of(0, 1, 3, 6);
    config.ground_radius_voxels = one_of(0, 2, 8);
    config.ground_layers_voxels = one_of(0, 1, 3);
    config.min_seeds_voxels = one_of(1, 3, 5);
    config.min_pure_seeds_voxels = one_of(1, 2, 9);
    config.min_seed_share = one_of(0.0, 0.1, 0.5);
    config.fresh_age_s = one_of(0.0, 0.2, 3.0);
    config.min_fresh_share = one_of(0.0, 0.2, 0.7);
    config.max_aged_share = one_of(0.0, 0.3, 0.6, 1.0);
    config.max_settled_share = one_of(0.0, 0.3, 0.3, 1000.0);
    config.rise_radius_m = one_of(0.0, 0.7, 6.0);
    config.min_rise_voxels = one_of(0, 1, 2, 4);
    config.max_growth_m = one_of(0.0, 0.4, 0.8, 3.0);
    config.max_extent_m = one_of(0.8, 2.0, 10.0);
    config.max_pure_extent_m = one_of(0.5, 1.2, 20.0);
    config.max_height_m = one_of(0.5, 1.0, 4.5);
    config.min_track_steps = one_of(0, 1, 1, 2);
    const SmallWorld world = small_world({.seed = seed,
                                          .scans = 20,
                                          .moving_boxes = one_of(1, 2, 3),
                                          .noise_m = one_of(0.0, 0.05),
                                          .walk_m = one_of(0.0, 0.1, 0.4),
                                          .origin_m = {one_of(0.0, 446'123.4), -31.7, 412.3},
                                          .defects = one_of(0, 1) == 1});
    expect_twins_labels(world, config, tally, one_of(1U, 3U));
  }
  EXPECT_EQ(tally.sequences, 30U);
  EXPECT_GT(tally.moving_points, 500U);
}

}  // namespace
}  // namespace mosbench
