#include "core/methods/hmm_mos_plus/block_history.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace mosbench::hmm_mos_plus {
namespace {

BlockMask one_voxel() {
  BlockMask mask;
  mask.set(77);
  return mask;
}

/// One voxel that is seen free ('f') or occupied ('o') scan by scan; '.' is not observed.
struct OneVoxel {
  BlockHistory history;
  hmm_mos::BlockStates states;
  std::uint32_t scan = 0, steps = 1;

  void see(std::string_view states_seen) {
    for (const char seen : states_seen) {
      const hmm_mos::BlockStates before = states;
      if (seen == 'f') states = {.occupied = {}, .free = one_voxel()};
      if (seen == 'o') states = {.occupied = one_voxel(), .free = {}};
      const BlockMask observed = seen == '.' ? BlockMask{} : one_voxel();
      history.update(observed, before, states, {scan, steps});
      scan += steps;
    }
  }
  /// Asked in the scan that was seen last.
  bool arrived(std::uint32_t scans) const {
    return history.arrived_within(one_voxel(), scans, scan - steps).any();
  }
  bool sure(std::uint32_t scans) const {
    return history.sure_within(one_voxel(), scans, scan - steps).any();
  }
};

TEST(BlockHistory, CallsAnArrivalSureAfterThreeFreeScans) {
  OneVoxel twice, thrice, unseen;
  twice.see("ffo");
  thrice.see("f.f.fo");
  unseen.see("oo");
  EXPECT_TRUE(twice.arrived(0));
  EXPECT_FALSE(twice.sure(0));
  EXPECT_TRUE(thrice.sure(0));
  EXPECT_FALSE(unseen.arrived(10));
}

/// A pole that poses move to the next voxel and back.
TEST(BlockHistory, CallsNoReturnSureBeforeASecond) {
  OneVoxel early, at_limit, past_limit, unseen_first;
  early.see("oofffffffffo");
  ASSERT_EQ(early.scan, 12U) << "left in scan 2, back in 11";
  EXPECT_TRUE(early.arrived(0));
  EXPECT_FALSE(early.sure(0));
  at_limit.see("offffffffffo");
  past_limit.see("offfffffffffo");
  EXPECT_FALSE(at_limit.sure(0)) << "10 scans after it left";
  EXPECT_TRUE(past_limit.sure(0)) << "11 scans";
  unseen_first.see("fffo");
  EXPECT_TRUE(unseen_first.sure(0)) << "it left nothing";
}

TEST(BlockHistory, TellsWhatLeftUntilItIsBack) {
  OneVoxel voxel;
  const auto left = [&](std::uint32_t scans) {
    return voxel.history.left_within(one_voxel(), scans, voxel.scan - 1).any();
  };
  voxel.see("fff");
  EXPECT_FALSE(left(10)) << "nothing was there";
  voxel.see("oo");
  EXPECT_FALSE(left(10));
  voxel.see("f");
  EXPECT_TRUE(left(0));
  voxel.see(".f");
  EXPECT_FALSE(left(1));
  EXPECT_TRUE(left(2));
  voxel.see("o");
  EXPECT_FALSE(left(10));
}

/// Ticks are kept modulo 256.
TEST(BlockHistory, NeverTellsTwiceThatAVoxelWasLeft) {
  OneVoxel voxel;
  voxel.see("of");
  for (std::uint32_t age = 1; age < 600; ++age) {
    voxel.see("f");
    const std::uint32_t now = voxel.scan - 1;
    ASSERT_EQ(voxel.history.left_within(one_voxel(), 5, now).any(), age <= 5) << age;
  }
}

TEST(BlockHistory, CountsTheAgeOfAnArrivalInAllScans) {
  OneVoxel voxel;
  voxel.see("fffo..o");
  EXPECT_TRUE(voxel.sure(3));
  EXPECT_FALSE(voxel.sure(2));
}

TEST(BlockHistory, SettlesAVoxelAfterEightOccupiedScansUntilItIsFree) {
  OneVoxel voxel;
  voxel.see("ooooooo");
  EXPECT_FALSE(voxel.history.settled().any());
  voxel.see(".o");
  EXPECT_TRUE(voxel.history.settled().any());
  voxel.see("ooooooooooo");
  EXPECT_TRUE(voxel.history.settled().any());
  voxel.see("f");
  EXPECT_FALSE(voxel.history.settled().any());
  voxel.see("o");
  EXPECT_FALSE(voxel.history.settled().any());
}

TEST(BlockHistory, CallsAVoxelAgedFromTheFifthOccupiedScanUntilItIsFree) {
  OneVoxel voxel;
  for (std::size_t seen = 1; seen <= 20; ++seen) {
    voxel.see(seen % 3 == 0 ? ".o" : "o");
    EXPECT_EQ(voxel.history.aged().any(), seen >= BlockHistory::kAgedTicks) << seen;
  }
  voxel.see("f");
  EXPECT_FALSE(voxel.history.aged().any());
  voxel.see("oooo");
  EXPECT_FALSE(voxel.history.aged().any());
}

TEST(BlockHistory, CountsTicksRatherThanScans) {
  OneVoxel slow, fast;
  slow.steps = 2;
  slow.see("ffo");  // free for 1 + 2
  EXPECT_TRUE(slow.sure(0));
  slow.see("oo");  // 1 + 2 + 2
  EXPECT_TRUE(slow.history.aged().any());
  EXPECT_FALSE(slow.history.settled().any());
  slow.see("oo");
  EXPECT_TRUE(slow.history.settled().any());
  EXPECT_TRUE(slow.sure(8));
  EXPECT_FALSE(slow.sure(7));
  fast.steps = 0;
  fast.see("ffffffffo");
  EXPECT_TRUE(fast.arrived(0));
  EXPECT_FALSE(fast.sure(0)) << "no time passed";
}

TEST(BlockHistory, ForgetsAVoxelWholly) {
  OneVoxel voxel;
  voxel.see("fffo");
  voxel.history.forget(one_voxel());
  voxel.states = {};
  EXPECT_FALSE(voxel.arrived(100));
  voxel.see("fo");
  EXPECT_TRUE(voxel.arrived(0));
  EXPECT_FALSE(voxel.sure(0));
}

TEST(BlockHistory, TellsOfTheVoxelsThatAreAskedForAlone) {
  OneVoxel voxel;
  voxel.see("fffo");
  EXPECT_FALSE(voxel.history.arrived_within({}, 10, 3).any());
  EXPECT_FALSE(voxel.history.sure_within({}, 10, 3).any());
}

/// Ages are counted modulo 256: at every pace of updates and pauses none comes round.
TEST(BlockHistory, KnowsAgesExactlyWhateverTheTicksBetweenUpdates) {
  for (const std::uint32_t steps : {1U, 7U, 49U, 50U, 51U, 99U, 100U, 101U, 149U, 255U, 256U}) {
    for (std::uint32_t pause = 0; pause < 600; pause += 13) {
      OneVoxel voxel;
      voxel.see("fffo");
      const std::uint32_t arrival = voxel.scan - 1;
      voxel.steps = steps;
      for (int update = 0; update < 12; ++update) {
        const std::uint32_t now = voxel.scan;
        voxel.see("o");
        for (const std::uint32_t later : {now, now + pause}) {
          const bool young = voxel.history.sure_within(one_voxel(), 100, later).any();
          ASSERT_EQ(young, later - arrival <= 100) << steps << ' ' << pause;
        }
      }
    }
  }
}

TEST(BlockHistory, NeverMakesAnOldArrivalYoungAgain) {
  OneVoxel watched;
  watched.see("fffo");
  for (std::uint32_t k = 0; k < 70'000; ++k) {
    watched.see("o");
    ASSERT_EQ(watched.arrived(BlockHistory::kMaxAgeTicks), k < BlockHistory::kMaxAgeTicks) << k;
  }
  for (std::uint32_t pause = BlockHistory::kMaxAgeTicks + 1; pause < 66'000; pause += 251) {
    OneVoxel alone;
    alone.see("fffo");
    alone.scan += pause;
    ASSERT_FALSE(alone.arrived(BlockHistory::kMaxAgeTicks)) << pause;
    alone.see(".");
    ASSERT_FALSE(alone.arrived(BlockHistory::kMaxAgeTicks)) << pause;
  }
}

}  // namespace
}  // namespace mosbench::hmm_mos_plus
