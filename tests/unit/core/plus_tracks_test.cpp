#include <gtest/gtest.h>

#include <vector>

#include "core/hmm_mos_plus/tracks.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

constexpr hmm_mos::Tick kTick;

/// A box of 3^3 voxels, all occupied, that moves: at x, and y = z = -1.
struct Box {
  VoxelizedScan scan;
  Component component{.voxels = {}, .seed_share = 1, .moves = true};

  explicit Box(int x) {
    for (int dz = 0; dz < 3; ++dz) {
      for (int dy = 0; dy < 3; ++dy) {
        for (int dx = 0; dx < 3; ++dx) add({x + dx, dy - 1, dz - 1});
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

/// Returns the number of voxels of a box at x that are seeds by what was followed.
std::size_t seeds_at(int x, const Tracks& tracks, const hmm_mos::Tick& tick = kTick,
                     bool settled = false, bool low = false) {
  const Box box(x);
  const ScanMasks none(box.scan.occupied.size());
  ArrivalClasses classes{none, none, settled ? box.scan.occupied : none, none};
  tracks.add_seeds(box.scan, low ? box.scan.occupied : none, tick, classes);
  EXPECT_EQ(classes.seeds, classes.fresh);
  std::size_t seeds = 0;
  for (const BlockMask& mask : classes.seeds) seeds += mask.count();
  return seeds;
}

Tracks followed(const std::vector<int>& xs, const hmm_mos::Tick& tick = kTick,
                const Config& config = {}) {
  Tracks tracks(config);
  for (const int x : xs) {
    const Box box(x);
    tracks.follow(box.scan, {box.component}, tick);
  }
  return tracks;
}

TEST(PlusTracks, PredictOneStepOfTheLastLength) {
  EXPECT_EQ(seeds_at(0, followed({0})), 0U) << "seen once";
  EXPECT_EQ(seeds_at(9, followed({-1, 4})), 27U);
  EXPECT_EQ(seeds_at(8, followed({-1, 4})), 18U);
  EXPECT_EQ(seeds_at(12, followed({-1, 4})), 0U);
  EXPECT_EQ(seeds_at(-14, followed({0, -4, -9})), 27U);
}

TEST(PlusTracks, PredictNothingOfWhatStands) {
  EXPECT_EQ(seeds_at(4, followed({0, 4, 4})), 0U);
  EXPECT_EQ(seeds_at(5, followed({0, 4, 5})), 18U) << "a step of one voxel is one";
}

TEST(PlusTracks, CountScansThatAreMissing) {
  const hmm_mos::Tick late{.at = 3, .steps = 3, .periods = 3, .period_s = 0.1};
  EXPECT_EQ(seeds_at(10, followed({0, 4}), late), 0U);
  EXPECT_EQ(seeds_at(16, followed({0, 4}), late), 27U);
}

TEST(PlusTracks, PredictNothingThatIsSettledOrLow) {
  EXPECT_EQ(seeds_at(8, followed({0, 4}), kTick, true, false), 0U);
  EXPECT_EQ(seeds_at(8, followed({0, 4}), kTick, false, true), 0U);
}

/// Voxels of 0.2 m: 20 m/s are 10 of them per scan.
TEST(PlusTracks, FollowWhatIsNearWhereItIsExpected) {
  Config config;
  config.map.voxel_size_m = 0.2;
  EXPECT_EQ(seeds_at(20, followed({0, 10}, kTick, config)), 27U);
  EXPECT_EQ(seeds_at(22, followed({0, 11}, kTick, config)), 0U);
  EXPECT_EQ(seeds_at(60, followed({0, 10, 30, 45}, kTick, config)), 27U);
  const hmm_mos::Tick slow{.at = 0, .steps = 2, .periods = 1, .period_s = 0.2};
  EXPECT_EQ(seeds_at(40, followed({0, 20}, slow, config), slow), 27U);
}

TEST(PlusTracks, FollowNothingOverMoreThanASecond) {
  const hmm_mos::Tick long_after{.at = 11, .steps = 11, .periods = 11, .period_s = 0.1};
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
  tracks.follow(still.scan, {still.component}, kTick);
  EXPECT_EQ(seeds_at(8, tracks), 0U);
  EXPECT_EQ(seeds_at(12, tracks), 0U);
}

}  // namespace
}  // namespace mosbench::hmm_mos_plus
