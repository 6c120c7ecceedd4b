#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/voxel/block_map.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

TEST(BlockTable, EqualsAMapUnderInsertFindAndErase) {
  std::mt19937 random(81);
  for (const int reach : {3, 6, 1000, 1 << 20}) {
    BlockTable table;
    std::map<Triple, std::uint32_t> twin;
    std::vector<Triple> asked;
    std::size_t erased = 0, largest = 0;
    for (std::uint32_t step = 0; step < 30'000; ++step) {
      const auto coordinate = [&] {
        return static_cast<int>(random() % static_cast<unsigned>(2 * reach)) - reach;
      };
      Triple v{coordinate(), coordinate(), coordinate()};
      if (!asked.empty() && random() % 2 == 0) v = asked[random() % asked.size()];
      asked.push_back(v);
      if (asked.size() > 400) asked.erase(asked.begin());
      const BlockIndex block{v[0], v[1], v[2]};
      // Growing and shrinking phases.
      if (random() % 100 < (step / 5000 % 2 == 0 ? 35U : 65U)) {
        erased += twin.erase(v);
        table.erase(block);
      } else {
        ASSERT_EQ(table.find_or_insert(block, step), twin.try_emplace(v, step).first->second);
      }
      ASSERT_EQ(table.size(), twin.size());
      largest = std::max(largest, twin.size());
      const Triple& other = asked[random() % asked.size()];
      const auto found = twin.find(other);
      ASSERT_EQ(table.find({other[0], other[1], other[2]}),
                found == twin.end() ? kNoSlot : found->second);
    }
    for (const auto& [v, slot] : twin) ASSERT_EQ(table.find({v[0], v[1], v[2]}), slot);
    EXPECT_GT(erased, 1000U);
    EXPECT_GT(largest, 50U);
    table.clear();
    EXPECT_EQ(table.size(), 0U);
    for (const auto& [v, slot] : twin) ASSERT_EQ(table.find({v[0], v[1], v[2]}), kNoSlot);
  }
}

TEST(VoxelSet, HoldsWhatWasPutIn) {
  std::mt19937 random(82);
  const Triples voxels = random_triples(random, 3000, 40);
  VoxelSet set = voxel_set(voxels);
  EXPECT_EQ(triples(set), voxels);
  for (const Triple& v : random_triples(random, 3000, 44)) {
    ASSERT_EQ(set.contains({v[0], v[1], v[2]}), voxels.contains(v));
  }
  set.clear();
  EXPECT_TRUE(triples(set).empty());
  EXPECT_EQ(set.mask_of({0, 0, 0}), nullptr);
}

TEST(Voxel, BlocksAndCellsCoverNegativeIndices) {
  EXPECT_EQ(block_of({-1, -8, -9}), (BlockIndex{-1, -1, -2}));
  EXPECT_EQ(cell_of({-1, -8, -9}), 7U + 0U * 8 + 7U * 64);
  for (std::uint32_t cell = 0; cell < 512; ++cell) {
    const Voxel v = voxel_at({-3, 0, 5}, cell);
    ASSERT_EQ(block_of(v), (BlockIndex{-3, 0, 5}));
    ASSERT_EQ(cell_of(v), cell);
  }
}

TEST(BlockMask, CombinesBitByBit) {
  BlockMask a, b;
  a.set(0);
  a.set(511);
  b.set(511);
  b.set(64);
  EXPECT_EQ((a & b).count(), 1U);
  EXPECT_EQ((a | b).count(), 3U);
  EXPECT_TRUE(without(a, b).test(0));
  EXPECT_EQ(without(a, b).count(), 1U);
  EXPECT_EQ((~a).count(), 510U);
  EXPECT_FALSE(BlockMask{}.any());
  std::vector<std::uint32_t> cells;
  for_each_cell(a | b, [&](std::uint32_t cell) { cells.push_back(cell); });
  EXPECT_EQ(cells, (std::vector<std::uint32_t>{0, 64, 511}));
}

TEST(Pool, SlotsInUseAreDistinctAndKeepTheirPlace) {
  std::mt19937 random(83);
  SlotPool<int> pool;
  std::map<std::uint32_t, const int*> in_use;
  for (int step = 0; step < 5000; ++step) {
    if (in_use.empty() || random() % 5 < (step < 2500 ? 4U : 1U)) {
      const std::uint32_t slot = pool.take();
      ASSERT_LT(slot, pool.capacity());
      ASSERT_TRUE(in_use.emplace(slot, &pool[slot]).second) << "a slot was handed out twice";
      pool[slot] = static_cast<int>(slot);
    } else {
      const auto chosen =
          std::next(in_use.begin(), static_cast<std::ptrdiff_t>(random() % in_use.size()));
      pool.give_back(chosen->first);
      in_use.erase(chosen);
    }
    ASSERT_EQ(pool.in_use(), in_use.size());
  }
  for (const auto& [slot, address] : in_use) {
    EXPECT_EQ(&pool[slot], address);
    EXPECT_EQ(pool[slot], static_cast<int>(slot));
  }
  EXPECT_LT(pool.capacity(), 2500U);
  EXPECT_GE(pool.memory_bytes(), pool.capacity() * sizeof(int));
}

TEST(Pool, FreedSlotsAreUsedAgain) {
  SlotPool<int> pool;
  for (int i = 0; i < 10'000; ++i) pool.give_back(pool.take());
  EXPECT_EQ(pool.in_use(), 0U);
  EXPECT_LE(pool.capacity(), 256U);
}

}  // namespace
}  // namespace mosbench
