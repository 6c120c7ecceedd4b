#include <gtest/gtest.h>

#include <limits>

#include "core/methods/underwood/pipeline.hpp"
#include "core/voxel/directions.hpp"
#include "tests/small_world.hpp"

/// underwood against all pairs of points.
namespace mosbench {
namespace {

/// Looks at every reference point for a query.
bool is_changed(const std::vector<Direction>& reference, const Direction& query, float alpha_rad,
                float rho_m) {
  bool right = false, left = false, below = false, above = false;
  for (const Direction& n : reference) {
    if (n.range_m == 0) continue;
    const float b = bearing_difference_rad(query.bearing_rad, n.bearing_rad);
    const float e = n.elevation_rad - query.elevation_rad;
    if (b * b + e * e > alpha_rad * alpha_rad) continue;
    if (n.range_m - query.range_m < rho_m) return false;
    right = right || b <= 0;
    left = left || b >= 0;
    below = below || e < 0;
    above = above || e > 0;
  }
  return right && left && below && above;
}

struct UnderwoodTally {
  std::size_t moving = 0, scans = 0;
};

void expect_all_pairs(const SmallWorld& world, const underwood::Config& config, unsigned threads,
                      UnderwoodTally& tally) {
  underwood::Pipeline pipeline(config, {.threads = threads});
  underwood::Pipeline scoring(config, {.scores = true});
  const std::vector<LabelledScan> results = results_of(pipeline, world);
  const std::vector<LabelledScan> scored = results_of(scoring, world);
  ASSERT_EQ(results.size(), world.scans.size());
  ThreadPool pool(1);
  const auto alpha_rad = static_cast<float>(config.neighbour_angle_rad);
  const auto rho_m = static_cast<float>(config.range_tolerance_m);
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    std::vector<int> votes(world.scans[k].size());
    const auto vote = [&](std::size_t reference) {
      const auto seen =
          directions_of(world.scans[reference], Pose::Identity(),
                        {config.min_range_m, std::numeric_limits<double>::max()}, pool);
      const auto queries =
          directions_of(world.scans[k], world.poses[reference].inverse() * world.poses[k],
                        {config.min_range_m, config.max_range_m}, pool);
      for (std::size_t i = 0; i < votes.size(); ++i) {
        votes[i] += queries[i].range_m > 0 && is_changed(seen, queries[i], alpha_rad, rho_m);
      }
    };
    for (int r = 1; r <= config.references; ++r) {
      const auto back = static_cast<std::size_t>(r * config.reference_offset_scans);
      if (back <= k) vote(k - back);
    }
    const std::size_t later = k + static_cast<std::size_t>(config.delay_scans);
    if (later > k && later < world.scans.size()) vote(later);
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const auto label = votes[i] >= config.min_votes ? kMovingLabel : kStaticLabel;
      ASSERT_EQ(results[k].labels[i], label) << "scan " << k << " point " << i;
      ASSERT_EQ(scored[k].labels[i], label) << "scan " << k << " point " << i;
      if (scored[k].judged) {
        ASSERT_EQ(scored[k].scores[i] >= rho_m, label == kMovingLabel);
      }
      tally.moving += label == kMovingLabel;
    }
    ++tally.scans;
  }
}

TEST(UnderwoodAgainstAllPairs, AgreesOnlineAndDelayed) {
  UnderwoodTally tally;
  for (unsigned seed = 0; seed < 12; ++seed) {
    underwood::Config config;
    config.min_range_m = 0.3;
    config.max_range_m = seed % 2 == 0 ? 5.0 : 2.5;
    config.neighbour_angle_rad = seed % 3 == 0 ? 0.15 : 0.3;
    config.reference_offset_scans = 1 + static_cast<int>(seed % 4);
    config.references = 1 + static_cast<int>(seed % 3);
    config.delay_scans = seed % 2 == 0 ? 0 : 3;
    config.min_votes = seed % 3 == 1 ? 2 : 1;
    expect_all_pairs(small_world({.seed = seed, .scans = 10, .defects = seed % 4 == 3}), config,
                     1 + seed % 3, tally);
  }
  EXPECT_EQ(tally.scans, 120U);
  EXPECT_GT(tally.moving, 500U);
}

}  // namespace
}  // namespace mosbench
