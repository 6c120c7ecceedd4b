#include "core/methods/hmm_mos/pipeline.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "tests/small_world.hpp"

/// The core against the slow twin, label for label and score for score, on small seeded worlds.
namespace mosbench {
using namespace hmm_mos;
namespace {

/// Totals over the comparisons of one test, so that it cannot pass on scans without motion.
struct Tally {
  std::size_t sequences = 0, with_motion = 0, moving_points = 0;
};

std::string to_text(const Config& config) {
  std::ostringstream text;
  for (const Setting& setting : settings_of(config).all()) {
    if (setting.is_set) text << ' ' << setting.name << ' ' << to_string(setting.value);
  }
  return text.str();
}

enum class Length { kKnown, kUnknown };

void expect_equal_labels(const SmallWorld& world, const Config& config, Variant variant,
                         Tally& tally, Length length = Length::kKnown, unsigned threads = 1) {
  const bool known = length == Length::kKnown;
  const std::optional<std::size_t> scan_count =
      known ? std::optional(world.scans.size()) : std::nullopt;
  const auto twin =
      make_reference(of_variant(config, variant), {.scan_count = scan_count, .scores = true});
  Pipeline pipeline(of_variant(config, variant), {threads, scan_count, true});
  const std::vector<LabelledScan> expected = results_of(*twin, world);
  const std::vector<LabelledScan> results = results_of(pipeline, world);
  ASSERT_EQ(results.size(), world.scans.size());
  ASSERT_EQ(results.size(), expected.size());
  std::vector<std::vector<std::uint32_t>> labels;
  for (std::size_t k = 0; k < results.size(); ++k) {
    ASSERT_EQ(results[k].labels.size(), world.scans[k].size());
    ASSERT_EQ(results[k].labels, expected[k].labels) << "scan " << k << ": " << to_text(config);
    ASSERT_EQ(results[k].scores, expected[k].scores) << "scan " << k << ": " << to_text(config);
    ASSERT_EQ(results[k].judged, expected[k].judged);
    ASSERT_EQ(results[k].nonfinite_points, expected[k].nonfinite_points);
    labels.push_back(results[k].labels);
  }
  const std::size_t moving = moving_points(labels);
  ++tally.sequences;
  tally.with_motion += moving > 0;
  tally.moving_points += moving;
}

void expect_equal_labels_of_both_variants(const SmallWorld& world, Config config, Tally& tally) {
  expect_equal_labels(world, config, Variant::kPaper2024, tally);
  config.delay_scans = 0;
  expect_equal_labels(world, config, Variant::kRelease2025, tally);
}

/// Most sequences have to contain what the method is about.
void expect_motion(const Tally& tally, std::size_t sequences) {
  EXPECT_EQ(tally.sequences, sequences);
  EXPECT_GE(tally.with_motion * 2, tally.sequences);
  EXPECT_GE(tally.moving_points, tally.sequences * 20);
}

TEST(PipelineAgainstTheSlowTwin, AgreesOnRigsOfTwoSensors) {
  Tally tally;
  std::size_t changed = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const SmallWorld rig = small_world({.seed = seed, .mounts_m = two_mounts()});
    Config config = small_world_config();
    config.max_range_m = seed % 2 == 0 ? 5.0 : 2.5;
    config.delay_scans = seed % 3 == 0 ? 2 : 0;
    expect_equal_labels_of_both_variants(rig, config, tally);
    SmallWorld one = rig;
    one.origins.clear();
    changed +=
        labels_of(rig, config, Variant::kPaper2024) != labels_of(one, config, Variant::kPaper2024);
  }
  expect_motion(tally, 16);
  EXPECT_GT(changed, 1U) << "rays of one origin give the same";
}

TEST(PipelineAgainstTheSlowTwin, AgreesWithThePapersParameters) {
  Tally tally;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    expect_equal_labels_of_both_variants(world, small_world_config(), tally);
  }
  expect_motion(tally, 24);
}

TEST(PipelineAgainstTheSlowTwin, AgreesForEveryDelay) {
  Tally tally;
  for (unsigned seed = 100; seed < 105; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .defects = seed % 2 == 0});
    for (const int delay : {1, 3, 5, 8, 12, 15, 16, 17, 40}) {
      Config config = small_world_config();
      config.delay_scans = delay;
      expect_equal_labels(world, config, Variant::kPaper2024, tally);
      expect_equal_labels(world, config, Variant::kPaper2024, tally, Length::kUnknown);
    }
  }
  EXPECT_EQ(tally.sequences, 90U);
  EXPECT_GE(tally.with_motion, 30U);
}

TEST(PipelineAgainstTheSlowTwin, AgreesForEveryKernelWidth) {
  Tally tally;
  for (unsigned seed = 200; seed < 206; ++seed) {
    const SmallWorld world = small_world({.seed = seed});
    for (const int width : {1, 3, 5, 7}) {
      Config config = small_world_config();
      config.kernel_width_voxels = width;
      config.min_otsu_score = width == 1 ? 0 : 1;
      config.delay_scans = seed % 2 == 0 ? 0 : 2;
      expect_equal_labels_of_both_variants(world, config, tally);
    }
  }
  expect_motion(tally, 48);
}

TEST(PipelineAgainstTheSlowTwin, AgreesForAnySigma) {
  Tally tally;
  for (unsigned seed = 300; seed < 303; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .scans = 12});
    for (const double ratio : {0.2, 0.5, 0.9, 1.3, 1.7, 2.5, 3.3, 4.5}) {
      for (const int fields : {1, 2}) {
        Config config = small_world_config();
        config.occupancy_sigma_m = ratio * config.voxel_size_m;
        config.distance_field_scans = fields;
        config.delay_scans = fields;
        config.min_otsu_score = 1;
        expect_equal_labels_of_both_variants(world, config, tally);
      }
    }
  }
  expect_motion(tally, 96);
}

TEST(PipelineAgainstTheSlowTwin, AgreesWhenTheFilterIsQuickOrSlowToDecide) {
  Tally tally;
  for (unsigned seed = 400; seed < 404; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .noise_m = 0.02});
    for (const double p_min : {0.5, 0.7, 0.95, 0.9999, 0.999999}) {
      for (const double epsilon : {1e-4, 0.005, 0.2}) {
        Config config = small_world_config();
        config.min_state_probability = p_min;
        config.transition_epsilon = epsilon;
        config.delay_scans = seed % 2 == 0 ? 0 : 3;
        expect_equal_labels(world, config, Variant::kPaper2024, tally);
      }
    }
  }
  expect_motion(tally, 60);
}

/// Likelihoods are cut off where no state can depend on them: farthest out, in sigmas and in
/// voxels, for the smallest epsilon.
TEST(PipelineAgainstTheSlowTwin, AgreesForTheSmallestEpsilonWithAWideSigma) {
  Tally tally;
  for (unsigned seed = 450; seed < 453; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .scans = 16, .noise_m = 0.02});
    for (const double ratio : {1.0, 2.0, 3.2}) {
      for (const double p_min : {0.5, 0.99, 0.999999}) {
        Config config = small_world_config();
        config.transition_epsilon = 1e-6;
        config.min_state_probability = p_min;
        config.occupancy_sigma_m = ratio * config.voxel_size_m;
        config.min_otsu_score = 1;
        expect_equal_labels_of_both_variants(world, config, tally);
      }
    }
  }
  EXPECT_EQ(tally.sequences, 54U);
  EXPECT_GE(tally.with_motion, 10U);
}

TEST(PipelineAgainstTheSlowTwin, AgreesWhenRecordsExpire) {
  Tally tally;
  for (unsigned seed = 500; seed < 502; ++seed) {
    // A sparse scan: most voxels are not seen in every scan, so that ages differ.
    const SmallWorld world = small_world(
        {.seed = seed, .scans = 28, .azimuths = 22, .elevations = 9, .jitter_rad = 0.1});
    for (const int w_g : {1, 2, 3, 5, 8, 13}) {
      for (const int w_l : {1, 2, 4}) {
        Config config = small_world_config();
        config.global_window_scans = w_g;
        config.local_window_scans = w_l;
        config.dynamic_window_scans = w_g % 4 + 1;
        config.min_otsu_score = 1;
        expect_equal_labels_of_both_variants(world, config, tally);
      }
    }
  }
  EXPECT_EQ(tally.sequences, 72U);
  EXPECT_GE(tally.with_motion, 36U);
}

TEST(PipelineAgainstTheSlowTwin, AgreesWhenRecordsExpireWithinTheDelay) {
  Tally tally;
  for (unsigned seed = 600; seed < 603; ++seed) {
    const SmallWorld world = small_world(
        {.seed = seed, .scans = 24, .azimuths = 26, .elevations = 10, .jitter_rad = 0.1});
    for (const int w_g : {1, 2, 3, 4, 6}) {
      for (const int delay : {2, 4, 7}) {
        Config config = small_world_config();
        config.global_window_scans = w_g;
        config.delay_scans = delay;
        config.min_otsu_score = 0;
        expect_equal_labels(world, config, Variant::kPaper2024, tally);
      }
    }
  }
  EXPECT_EQ(tally.sequences, 45U);
  EXPECT_GE(tally.with_motion, 20U);
}

TEST(PipelineAgainstTheSlowTwin, AgreesWhenTheSensorJumps) {
  Tally tally;
  const std::vector<std::vector<Eigen::Vector3d>> journeys = {
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {60, 0, 0}},
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {9.1, 0, 0}, {0, 0, 0}, {0, 0, 0}},
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 7.7, 0}, {0, 7.7, 0}, {0, 0, 0}},
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {5, 0, 0}, {10, 0, 0}, {5, 0, 0}},
      {{0, 0, 0},   {0.6, 0, 0}, {1.2, 0, 0}, {1.8, 0, 0}, {2.4, 0, 0}, {3.0, 0, 0}, {3.6, 0, 0},
       {4.2, 0, 0}, {4.8, 0, 0}, {5.4, 0, 0}, {6.0, 0, 0}, {6.6, 0, 0}, {7.2, 0, 0}, {7.8, 0, 0},
       {8.4, 0, 0}, {9.0, 0, 0}, {6.0, 0, 0}, {3.0, 0, 0}, {0, 0, 0},   {0, 0, 0}},
  };
  for (unsigned seed = 700; seed < 702; ++seed) {
    for (const std::vector<Eigen::Vector3d>& jumps_m : journeys) {
      const SmallWorld world = small_world({.seed = seed, .scans = 40, .jumps_m = jumps_m});
      for (const int delay : {0, 3}) {
        Config config = small_world_config();
        config.max_range_m = seed % 2 == 0 ? 4.0 : 5.0;
        config.delay_scans = delay;
        config.min_otsu_score = 1;
        expect_equal_labels_of_both_variants(world, config, tally);
      }
    }
  }
  expect_motion(tally, 40);
}

TEST(PipelineAgainstTheSlowTwin, AgreesOnHostileScans) {
  Tally tally;
  for (unsigned seed = 800; seed < 824; ++seed) {
    const SmallWorld world = small_world({.seed = seed, .scans = 24, .defects = true});
    Config config = small_world_config();
    config.delay_scans = static_cast<int>(seed % 4);
    expect_equal_labels_of_both_variants(world, config, tally);
  }
  EXPECT_EQ(tally.sequences, 48U);
  EXPECT_GE(tally.with_motion, 24U);
}

TEST(PipelineAgainstTheSlowTwin, AgreesFarFromTheOrigin) {
  Tally tally;
  for (unsigned seed = 900; seed < 906; ++seed) {
    for (const Eigen::Vector3d& origin_m :
         {Eigen::Vector3d{-470.3, -31.7, -12.9}, Eigen::Vector3d{446'123.4, 5'412'345.6, 412.3},
          Eigen::Vector3d{-5e6, 5e6, -900.0}}) {
      const SmallWorld world = small_world({.seed = seed, .origin_m = origin_m});
      Config config = small_world_config();
      config.delay_scans = seed % 2 == 0 ? 0 : 2;
      expect_equal_labels_of_both_variants(world, config, tally);
    }
  }
  expect_motion(tally, 36);
}

/// With whole numbers everywhere many voxels lie exactly at a limit.
TEST(PipelineAgainstTheSlowTwin, AgreesWhenVoxelsLieExactlyAtTheLimits) {
  Tally tally;
  for (unsigned seed = 1000; seed < 1010; ++seed) {
    SmallWorld world = small_world({.seed = seed, .walk_m = 0.0});
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      world.poses[k].linear().setIdentity();
      world.poses[k].translation().array() = std::round(world.poses[k].translation().x());
      for (Point& p : world.scans[k]) {
        p = {std::round(p.x * 4) / 4, std::round(p.y * 4) / 4, std::round(p.z * 4) / 4, 0.0F};
      }
    }
    Config config = small_world_config();
    config.voxel_size_m = 0.25;
    config.min_range_m = 1.25;
    config.max_range_m = seed % 2 == 0 ? 3.0 : 2.5;
    expect_equal_labels_of_both_variants(world, config, tally);
  }
  EXPECT_EQ(tally.sequences, 20U);
  EXPECT_GE(tally.with_motion, 5U);
}

/// All settings drawn at random, in combinations that no list of cases would contain.
TEST(PipelineAgainstTheSlowTwin, AgreesOnRandomConfigurations) {
  Tally tally;
  for (unsigned seed = 2000; seed < 2080; ++seed) {
    std::mt19937 random(seed);
    const auto one_of = [&](auto... choices) {
      const std::array list = {choices...};
      return list[random() % list.size()];
    };
    Config config = small_world_config();
    config.voxel_size_m = one_of(0.25, 0.3, 0.4, 0.5);
    config.max_range_m = one_of(2.5, 4.0, 5.0, 6.0);
    config.min_range_m = one_of(0.0, 0.3, 1.0);
    if (one_of(0, 1) == 1) config.occupancy_sigma_m = config.voxel_size_m * one_of(0.7, 1.5, 2.0);
    config.kernel_width_voxels = one_of(1, 3, 3, 5);
    config.delay_scans = one_of(0, 0, 1, 3, 6);
    config.local_window_scans = one_of(1, 2, 3, 5);
    config.global_window_scans = one_of(1, 4, 9, 300);
    config.dynamic_window_scans = one_of(1, 3, 6, 100);
    config.min_otsu_score = one_of(0, 1, 3);
    config.min_state_probability = one_of(0.6, 0.9, 0.99);
    config.distance_field_scans = one_of(1, 2);
    const SmallWorld world = small_world({.seed = seed,
                                          .scans = 20,
                                          .azimuths = one_of(16, 30),
                                          .elevations = one_of(8, 12),
                                          .moving_boxes = one_of(1, 2, 3),
                                          .noise_m = one_of(0.0, 0.05),
                                          .walk_m = one_of(0.0, 0.1, 0.4),
                                          .defects = one_of(0, 1) == 1});
    const unsigned threads = one_of(1U, 3U);
    expect_equal_labels(world, config, Variant::kPaper2024, tally,
                        one_of(Length::kKnown, Length::kUnknown), threads);
    config.delay_scans = 0;
    expect_equal_labels(world, config, Variant::kRelease2025, tally, Length::kKnown, threads);
  }
  EXPECT_EQ(tally.sequences, 160U);
  EXPECT_GE(tally.with_motion, 50U);
}

}  // namespace
}  // namespace mosbench
