#include <gtest/gtest.h>

#include <vector>

#include "core/methods/hmm_mos_plus/tracks.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

constexpr hmm_mos_plus::Tick kTick;

/// A box of 3^3 voxels, all occupied, that moves: its lowest corner is at x, y and z.
struct Box {
  VoxelizedScan scan;
  Component component{.voxels = {}, .seed_share = 1, .moves = true};

  explicit Box(int x, int y = -1, int z = -1) {
    for (int dz = 0; dz < 3; ++dz) {
      for (int dy = 0; dy < 3; ++dy) {
        for (int dx = 0; dx < 3; ++dx) add({x + dx, y + dy, z + dz});
      }
    }
    scan.occupied = scan.measured.masks;
  }

  void add(const Voxel& v) {
    const std::uint32_t slot = scan.measured.insert(block_of(v));
    scan.measured.masks[slot].set(cell_of(v));
    component.voxels.push_back(slot * kBlockVoxels + cell_of(v));
  }
};

/// What a box is besides occupied.
struct Kind {
  bool standing = false, low = false;
};

/// Returns the voxels of a box that are seeds by what was followed.
std::vector<Voxel> predicted(const Box& box, const Tracks& tracks,
                             const hmm_mos_plus::Tick& tick = kTick, const Kind& kind = {}) {
  Box with_floor = box;
  for (int x = -40; x < 80; x += kBlockSide) with_floor.add({x, 0, -50});
  with_floor.scan.occupied = with_floor.scan.measured.masks;
  Config config;
  config.ground_radius_voxels = kBlockSide;
  if (kind.low) config.ground_layers_voxels = 100;
  const Ground ground(with_floor.scan, config);
  LowVoxels low(box.scan, ground);
  const ScanMasks none(box.scan.occupied.size());
  ArrivalClasses classes{none, none, none, none, none, none, none};
  if (kind.standing) classes.standing = box.scan.occupied;
  tracks.add_seeds(box.scan, low, tick, classes);
  EXPECT_EQ(classes.seeds, classes.fresh);
  std::vector<Voxel> seeds;
  for (std::size_t i = 0; i < classes.seeds.size(); ++i) {
    for_each_cell(classes.seeds[i], [&](std::uint32_t cell) {
      seeds.push_back(voxel_at(box.scan.measured.blocks[i], cell));
    });
  }
  return seeds;
}

std::size_t seeds_of(const Box& box, const Tracks& tracks) { return predicted(box, tracks).size(); }

std::size_t seeds_at(int x, const Tracks& tracks, const hmm_mos_plus::Tick& tick = kTick,
                     const Kind& kind = {}) {
  return predicted(Box(x), tracks, tick, kind).size();
}

Tracks followed(const std::vector<int>& xs, const hmm_mos_plus::Tick& tick = kTick,
                const Config& config = {}) {
  Tracks tracks(config);
  for (const int x : xs) {
    const Box box(x);
    std::vector<Component> components = {box.component};
    tracks.follow(box.scan, components, tick);
  }
  return tracks;
}

/// Returns the steady steps of a box that was at these places.
int steady_steps(const std::vector<int>& xs) {
  Tracks tracks((Config()));
  int steps = 0;
  for (const int x : xs) {
    const Box box(x);
    std::vector<Component> components = {box.component};
    tracks.follow(box.scan, components, kTick);
    steps = components.front().steady_steps;
  }
  return steps;
}

TEST(PlusTracks, CountTheStepsOfLikeVelocity) {
  EXPECT_EQ(steady_steps({0, 4}), 0) << "one step is like none";
  EXPECT_EQ(steady_steps({0, 4, 8}), 1);
  EXPECT_EQ(steady_steps({0, 4, 8, 12}), 2);
  EXPECT_EQ(steady_steps({0, 4, 10}), 1) << "half more";
  EXPECT_EQ(steady_steps({0, 4, 11}), 0);
  EXPECT_EQ(steady_steps({0, 4, 8, 12, 12}), 0) << "it stops";
  EXPECT_EQ(steady_steps({0, 0, 0, 0}), 0) << "it stands";
}

TEST(PlusTracks, PredictOneStepOfTheLastLength) {
  EXPECT_EQ(seeds_at(0, followed({0})), 0U) << "seen once";
  EXPECT_EQ(seeds_at(9, followed({-1, 4})), 27U);
  EXPECT_EQ(seeds_at(-14, followed({0, -4, -9})), 27U);
}

/// Expected at 9, y = -1 and z = -1.
TEST(PlusTracks, CorrectAStepByTwoVoxelsAlongXAndY) {
  const Tracks tracks = followed({-1, 4});
  EXPECT_EQ(seeds_at(8, tracks), 27U);
  EXPECT_EQ(seeds_at(11, tracks), 27U);
  EXPECT_EQ(seeds_at(12, tracks), 18U);
  EXPECT_EQ(seeds_at(14, tracks), 0U);
  EXPECT_EQ(seeds_of(Box(7, 1), tracks), 27U);
  EXPECT_EQ(seeds_of(Box(9, -4), tracks), 18U);
  EXPECT_EQ(seeds_of(Box(9, -1, 0), tracks), 18U) << "not along z";
}

/// Expected at 9 to 11, of a box from 8 to 12 that lacks an edge: corrections by one find as much.
TEST(PlusTracks, CorrectAStepNoMoreThanItTakes) {
  Box longer(8);
  for (int x = 11; x <= 12; ++x) {
    for (int dy = 0; dy < 3; ++dy) {
      for (int dz = 0; dz < 3; ++dz) longer.add({x, dy - 1, dz - 1});
    }
  }
  longer.scan.occupied = longer.scan.measured.masks;
  for (int x = 8; x <= 12; ++x) {
    const Voxel edge{x, -1, -1};
    BlockMask gone;
    gone.set(cell_of(edge));
    BlockMask& occupied = longer.scan.occupied[longer.scan.measured.find(block_of(edge))];
    occupied = without(occupied, gone);
  }
  const std::vector<Voxel> seeds = predicted(longer, followed({-1, 4}));
  ASSERT_EQ(seeds.size(), 24U);
  for (const Voxel& seed : seeds) EXPECT_TRUE(seed.x >= 9 && seed.x <= 11) << seed.x;
}

TEST(PlusTracks, PredictNothingOfWhatStands) {
  EXPECT_EQ(seeds_at(4, followed({0, 4, 4})), 0U);
  EXPECT_EQ(seeds_at(5, followed({0, 4, 5})), 18U)
      << "a step of one voxel is not corrected to none";
}

TEST(PlusTracks, CountScansThatAreMissing) {
  const hmm_mos_plus::Tick late{.at = 3, .steps = 3, .periods = 3, .period_s = 0.1};
  EXPECT_EQ(seeds_at(10, followed({0, 4}), late), 0U);
  EXPECT_EQ(seeds_at(16, followed({0, 4}), late), 27U);
}

TEST(PlusTracks, PredictNothingThatStandsOrIsLow) {
  EXPECT_EQ(seeds_at(8, followed({0, 4}), kTick, {.standing = true}), 0U);
  EXPECT_EQ(seeds_at(8, followed({0, 4}), kTick, {.low = true}), 0U);
}

/// Voxels of 0.2 m: 20 m/s are 10 of them per scan.
TEST(PlusTracks, FollowWhatIsNearWhereItIsExpected) {
  Config config;
  config.map.voxel_size_m = 0.2;
  EXPECT_EQ(seeds_at(20, followed({0, 10}, kTick, config)), 27U);
  EXPECT_EQ(seeds_at(22, followed({0, 11}, kTick, config)), 0U);
  EXPECT_EQ(seeds_at(60, followed({0, 10, 30, 45}, kTick, config)), 27U);
  const hmm_mos_plus::Tick slow{.at = 0, .steps = 2, .periods = 1, .period_s = 0.2};
  EXPECT_EQ(seeds_at(40, followed({0, 20}, slow, config), slow), 27U);
}

TEST(PlusTracks, FollowNothingOverMoreThanASecond) {
  const hmm_mos_plus::Tick long_after{.at = 11, .steps = 11, .periods = 11, .period_s = 0.1};
  EXPECT_EQ(seeds_at(0, followed({0, 0}), long_after), 0U);
  EXPECT_EQ(seeds_at(0, followed({0, 0}, long_after)), 0U);
}

TEST(PlusTracks, NeedTheStepsThatAreAskedFor) {
  Config config;
  config.min_track_steps = 2;
  EXPECT_EQ(seeds_at(8, followed({0, 4}, kTick, config)), 0U);
  EXPECT_EQ(seeds_at(12, followed({0, 4, 8}, kTick, config)), 27U);
}

TEST(PlusTracks, EndWhereNothingMoves) {
  Tracks tracks = followed({0, 4});
  Box still(8);
  still.component.moves = false;
  std::vector<Component> components = {still.component};
  tracks.follow(still.scan, components, kTick);
  EXPECT_EQ(seeds_at(8, tracks), 0U);
  EXPECT_EQ(seeds_at(12, tracks), 0U);
}

}  // namespace
}  // namespace mosbench::hmm_mos_plus
