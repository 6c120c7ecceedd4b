#include "core/methods/hmm_mos/convolution.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/voxel/neighbourhood.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

VoteField convolved(const VoxelizedScan& scan, const VoxelSet& changed, const Triples& known,
                    int width, ThreadPool& pool) {
  const VoxelSet changed_here = scan.occupied_among(changed);
  const auto slots = slots_within(scan, changed_here, radius_of(width));
  return convolve(scan, slots, changed_here, voxel_set(known), width, pool);
}

struct Around {
  int votes = 0;
  bool beside_unknown = false;
};

Around triple_loop(const Triple& v, int radius, const Triples& occupied, const Triples& changed,
                   const Triples& known) {
  Around around;
  for_cube(v, radius, [&](const Triple& u) {
    if (!known.contains(u)) {
      --around.votes;
      around.beside_unknown = true;
    } else if (occupied.contains(u) && changed.contains(u)) {
      ++around.votes;
    }
  });
  around.votes = std::max(around.votes, 0);
  return around;
}

Triples full_cube(int reach) {
  Triples cube;
  for_cube({0, 0, 0}, reach, [&](const Triple& v) { cube.insert(v); });
  return cube;
}

TEST(Convolution, CountsVotesAroundAVoxel) {
  const Triples occupied{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {-2, 2, -2}, {0, 9, 0}};
  const Triples changed{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {-2, 2, -2}, {5, 5, 5}};
  ThreadPool pool(1);
  const VoxelizedScan scan = scan_of(occupied);
  const VoteField votes = convolved(scan, voxel_set(changed), full_cube(12), 5, pool);
  EXPECT_EQ(value_at(votes, {0, 0, 0}), 3);
  EXPECT_EQ(value_at(votes, {1, 0, 0}), 3);
  EXPECT_EQ(value_at(votes, {-2, 2, -2}), 1);
  EXPECT_EQ(value_at(votes, {0, 9, 0}), 0);
  EXPECT_EQ(value_at(votes, {5, 5, 5}), 0) << "changed but not occupied";
}

TEST(Convolution, UnknownNeighboursVoteAgainst) {
  Triples known_voxels = full_cube(4);
  known_voxels.erase({1, 1, 1});
  known_voxels.erase({0, 1, 0});
  const Triples occupied{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  ThreadPool pool(1);
  const VoteField votes = convolved(scan_of(occupied), voxel_set(occupied), known_voxels, 3, pool);
  EXPECT_EQ(value_at(votes, {0, 0, 0}), 1);
}

TEST(Convolution, ASumBelowZeroIsNoVote) {
  Triples known_voxels = full_cube(4);
  for (const Triple& v : Triples{{0, 1, 0}, {0, -1, 0}, {0, 0, 1}}) known_voxels.erase(v);
  ThreadPool pool(1);
  const VoxelizedScan scan = scan_of({{0, 0, 0}, {1, 0, 0}});
  const VoteField votes = convolved(scan, voxel_set({{1, 0, 0}}), known_voxels, 3, pool);
  EXPECT_EQ(value_at(votes, {0, 0, 0}), 0);
  EXPECT_EQ(value_at(votes, {1, 0, 0}), 0);
  EXPECT_TRUE(votes.blocks.empty());
}

TEST(Convolution, EqualsTheTripleLoopForEveryKernel) {
  std::mt19937 random(91);
  std::size_t positive = 0, unknown = 0;
  for (const int width : {1, 3, 5, 7, 9, 15}) {
    const int radius = width / 2;
    for (int round = 0; round < 4; ++round) {
      const Triples occupied = random_triples(random, 500, 7);
      Triples known_voxels = full_cube(7 + radius + 1), changed;
      for (const Triple& v : random_triples(random, round < 2 ? 40 : 2, 15)) known_voxels.erase(v);
      for (const Triple& v : full_cube(9)) {
        if (random() % 3 == 0) changed.insert(v);
      }
      const VoxelSet known = voxel_set(known_voxels);
      ThreadPool pool(round % 2 == 0 ? 1 : 3);
      const VoxelizedScan scan = scan_of(occupied, {{9, 9, 9}, {-12, 0, 0}});
      const VoteField votes = convolved(scan, voxel_set(changed), known_voxels, width, pool);
      const auto slots = slots_around(scan, scan.measured.blocks);
      const Triples beside_voxels = triples(beside_unknown(scan, slots, known, width, pool));
      for (const Triple& v : occupied) {
        const Around expected = triple_loop(v, radius, occupied, changed, known_voxels);
        ASSERT_EQ(value_at(votes, v), expected.votes) << "width " << width;
        ASSERT_EQ(beside_voxels.contains(v), expected.beside_unknown) << "width " << width;
        positive += expected.votes > 0;
        unknown += expected.beside_unknown;
      }
      EXPECT_TRUE(std::includes(occupied.begin(), occupied.end(), beside_voxels.begin(),
                                beside_voxels.end()));
    }
  }
  EXPECT_GT(positive, 1500U);
  EXPECT_GT(unknown, 1500U);
}

TEST(Convolution, SlotsAroundAreTheScansBlocksWithinOneBlockWithoutRepeats) {
  const VoxelizedScan scan = scan_of({{0, 0, 0}, {8, 0, 0}, {16, 0, 0}, {24, 0, 0}, {0, -1, 0}});
  const std::vector<BlockIndex> centres{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  std::vector<std::uint32_t> slots = slots_around(scan, centres);
  std::sort(slots.begin(), slots.end());
  std::vector<std::uint32_t> expected;
  for (std::uint32_t slot = 0; slot < scan.measured.block_count(); ++slot) {
    if (scan.measured.blocks[slot].x < 3) expected.push_back(slot);
  }
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_EQ(slots, expected);
}

}  // namespace
}  // namespace mosbench
