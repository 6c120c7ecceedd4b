#include "core/methods/hmm_mos/median.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

using Scores = std::map<Triple, int>;

VoteField field_of(const Scores& scores) {
  std::map<Triple, VoteField::Block> blocks;
  for (const auto& [v, score] : scores) {
    const Voxel voxel{v[0], v[1], v[2]};
    const BlockIndex index = block_of(voxel);
    auto& block = blocks.try_emplace({index.x, index.y, index.z}).first->second;
    block[cell_of(voxel)] = static_cast<std::int16_t>(score);
  }
  VoteField field;
  for (const auto& [index, block] : blocks) field.add({index[0], index[1], index[2]}, block);
  return field;
}

int median_filtered(const Scores& scores, const Triples& occupied, const Triple& at) {
  ThreadPool pool(1);
  return value_at(median_filter(scan_of(occupied), field_of(scores), pool), at);
}

TEST(Median, EvenNumberOfScoresTruncatesTheMean) {
  // 3 and 6: 4.5 becomes 4, for both.
  EXPECT_EQ(median_filtered({{{0, 0, 0}, 3}, {{1, 0, 0}, 6}}, {{0, 0, 0}, {1, 0, 0}}, {0, 0, 0}),
            4);
  EXPECT_EQ(median_filtered({{{0, 0, 0}, 3}, {{1, 0, 0}, 6}}, {{0, 0, 0}, {1, 0, 0}}, {1, 0, 0}),
            4);
}

TEST(Median, OccupiedNeighboursWithoutScoreCountAsZero) {
  const Scores scores{{{0, 0, 0}, 9}};
  EXPECT_EQ(median_filtered(scores, {{0, 0, 0}}, {0, 0, 0}), 9);
  EXPECT_EQ(median_filtered(scores, {{0, 0, 0}, {0, 1, 1}}, {0, 0, 0}), 4);
  EXPECT_EQ(median_filtered(scores, {{0, 0, 0}, {0, 1, 1}, {1, 1, 1}}, {0, 0, 0}), 0);
}

TEST(Median, ReachesAcrossBlocksAndNoFartherThanOneVoxel) {
  const Scores scores{{{-1, -1, -1}, 8}, {{0, 0, 0}, 2}, {{2, 0, 0}, 100}};
  EXPECT_EQ(median_filtered(scores, {{-1, -1, -1}, {0, 0, 0}, {2, 0, 0}}, {0, 0, 0}), 5);
}

TEST(Median, EqualsTheSortOfUnfilteredNeighbours) {
  std::mt19937 random(61);
  std::size_t positive = 0;
  for (int round = 0; round < 40; ++round) {
    const Triples occupied = random_triples(random, 1200, 9);
    Scores scores;
    for (const Triple& v : occupied) {
      if (random() % 10 < 7) scores[v] = static_cast<int>(random() % 125);
    }
    ThreadPool pool(round % 2 == 0 ? 1 : 3);
    const VoteField filtered = median_filter(scan_of(occupied), field_of(scores), pool);
    for (const Triple& v : occupied) {
      std::vector<int> around;
      for_cube(v, 1, [&](const Triple& u) {
        if (occupied.contains(u)) around.push_back(scores.contains(u) ? scores.at(u) : 0);
      });
      std::sort(around.begin(), around.end());
      const std::size_t half = around.size() / 2;
      const int expected =
          around.size() % 2 == 1 ? around[half] : (around[half - 1] + around[half]) / 2;
      ASSERT_EQ(value_at(filtered, v), expected);
      positive += expected > 0;
    }
    for (std::size_t i = 0; i < filtered.blocks.size(); ++i) {
      for (std::uint32_t cell = 0; cell < 512; ++cell) {
        const Triple v = triple(voxel_at(filtered.blocks[i], cell));
        ASSERT_TRUE(occupied.contains(v) || filtered.values[i][cell] == 0);
      }
    }
  }
  EXPECT_GT(positive, 10'000U);
}

}  // namespace
}  // namespace mosbench
