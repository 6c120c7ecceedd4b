#include "core/hmm_mos/convolution.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// A map in which exactly the given voxels are known at scan 1.
class KnownVoxels {
 public:
  explicit KnownVoxels(const Triples& known) : map_(config(), grid()) {
    const VoxelSet set = voxel_set(known);
    ThreadPool pool(1);
    map_.update({set.blocks, set.masks}, {}, Eigen::Vector3d::Zero(), 1, pool);
    map_.evict(1);
  }
  VoxelMap& map() { return map_; }

 private:
  static Config config() {
    Config config;
    config.voxel_size_m = 0.1;
    return config;
  }
  static VoxelGrid grid() { return {.voxel_size_m = 0.1}; }

  VoxelMap map_;
};

struct Around {
  int score = 0;
  bool beside_unknown = false;
};

Around triple_loop(const Triple& v, int radius, const Triples& occupied, const Triples& changed,
                   const Triples& known) {
  Around around;
  for_cube(v, radius, [&](const Triple& u) {
    if (!known.contains(u)) {
      --around.score;
      around.beside_unknown = true;
    } else if (occupied.contains(u) && changed.contains(u)) {
      ++around.score;
    }
  });
  around.score = std::max(around.score, 0);
  return around;
}

Triples full_cube(int reach) {
  Triples cube;
  for_cube({0, 0, 0}, reach, [&](const Triple& v) { cube.insert(v); });
  return cube;
}

TEST(Convolution, CountsVotesAroundAVoxel) {
  KnownVoxels known(full_cube(12));
  const Triples occupied{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {-2, 2, -2}, {0, 9, 0}};
  const Triples changed{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {-2, 2, -2}, {5, 5, 5}};
  ThreadPool pool(1);
  const ScoreField scores =
      convolve(scan_of(occupied), voxel_set(changed), 5, known.map(), 1, pool);
  EXPECT_EQ(value_at(scores, {0, 0, 0}), 3);
  EXPECT_EQ(value_at(scores, {1, 0, 0}), 3);
  EXPECT_EQ(value_at(scores, {-2, 2, -2}), 1);
  EXPECT_EQ(value_at(scores, {0, 9, 0}), 0);
  EXPECT_EQ(value_at(scores, {5, 5, 5}), 0) << "changed but not occupied";
}

TEST(Convolution, UnknownNeighboursVoteAgainst) {
  Triples known_voxels = full_cube(4);
  known_voxels.erase({1, 1, 1});
  known_voxels.erase({0, 1, 0});
  KnownVoxels known(known_voxels);
  const Triples occupied{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  ThreadPool pool(1);
  const ScoreField scores =
      convolve(scan_of(occupied), voxel_set(occupied), 3, known.map(), 1, pool);
  EXPECT_EQ(value_at(scores, {0, 0, 0}), 1);
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
      KnownVoxels known(known_voxels);
      ThreadPool pool(round % 2 == 0 ? 1 : 3);
      const VoxelizedScan scan = scan_of(occupied, {{9, 9, 9}, {-12, 0, 0}});
      const ScoreField scores = convolve(scan, voxel_set(changed), width, known.map(), 1, pool);
      // Every other block from either list.
      std::vector<BlockIndex> even, odd;
      for (const BlockIndex& block : scan.measured.blocks) {
        (even.size() > odd.size() ? odd : even).push_back(block);
      }
      const Triples beside_voxels =
          triples(beside_unknown(scan, even, odd, width, known.map(), 1, pool));
      for (const Triple& v : occupied) {
        const Around expected = triple_loop(v, radius, occupied, changed, known_voxels);
        ASSERT_EQ(value_at(scores, v), expected.score) << "width " << width;
        ASSERT_EQ(beside_voxels.contains(v), expected.beside_unknown) << "width " << width;
        positive += expected.score > 0;
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
