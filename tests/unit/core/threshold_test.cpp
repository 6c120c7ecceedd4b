#include <gtest/gtest.h>

#include <map>

#include "core/methods/hmm_mos/convolution.hpp"
#include "core/methods/hmm_mos/otsu.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

using Sums = std::map<Triple, int>;

template <typename Field>
Field field_of(const Sums& sums) {
  std::map<Triple, typename Field::Block> blocks;
  for (const auto& [v, sum] : sums) {
    const Voxel voxel{v[0], v[1], v[2]};
    const BlockIndex index = block_of(voxel);
    auto& block = blocks.try_emplace({index.x, index.y, index.z}).first->second;
    block[cell_of(voxel)] = static_cast<typename Field::Block::value_type>(sum);
  }
  Field field;
  for (const auto& [index, block] : blocks) field.add({index[0], index[1], index[2]}, block);
  return field;
}

Triples dilated(const Triples& selected, const Triples& occupied) {
  Triples result;
  for (const Triple& v : selected) {
    for_cube(v, 1, [&](const Triple& u) {
      if (occupied.contains(u)) result.insert(u);
    });
  }
  return result;
}

TEST(LocalWindow, SumsTheLastScansAtOccupiedVoxelsOnly) {
  LocalWindow window(2);
  const VoxelizedScan scan = scan_of({{0, 0, 0}, {9, 0, 0}}, {{1, 0, 0}});
  window.join(field_of<VoteField>({{{0, 0, 0}, 100}}));
  window.join(field_of<VoteField>({{{0, 0, 0}, 5}, {{1, 0, 0}, 7}}));
  EXPECT_EQ(value_at(window.sums(scan), {0, 0, 0}), 105);
  EXPECT_EQ(value_at(window.sums(scan), {1, 0, 0}), 0);
  window.join(field_of<VoteField>({{{0, 0, 0}, 1}, {{9, 0, 0}, 3}}));
  EXPECT_EQ(value_at(window.sums(scan), {0, 0, 0}), 6);
  EXPECT_EQ(value_at(window.sums(scan), {9, 0, 0}), 3);
  window.join({});
  window.join({});
  EXPECT_TRUE(window.sums(scan).blocks.empty());
}

TEST(LocalWindow, EqualsAListOfMaps) {
  std::mt19937 random(71);
  for (const int scans : {1, 3, 5}) {
    LocalWindow window(scans);
    std::vector<Sums> twin;
    for (int k = 0; k < 12; ++k) {
      Sums scores;
      for (const Triple& v : random_triples(random, 300, 8)) {
        scores[v] = static_cast<int>(random() % 343);
      }
      window.join(field_of<VoteField>(scores));
      twin.push_back(scores);
      const Triples occupied = random_triples(random, 900, 10);
      const SumField sums = window.sums(scan_of(occupied));
      for (const Triple& v : occupied) {
        int expected = 0;
        for (int back = 0; back < scans && back <= k; ++back) {
          const Sums& of_scan = twin[static_cast<std::size_t>(k - back)];
          expected += of_scan.contains(v) ? of_scan.at(v) : 0;
        }
        ASSERT_EQ(value_at(sums, v), expected);
      }
    }
  }
}

TEST(Threshold, CountsOccupiedVoxelsWithoutSumAsZeros) {
  const VoxelizedScan scan = scan_of({{0, 0, 0}, {1, 0, 0}, {20, 0, 0}, {40, 0, 0}});
  EXPECT_EQ(threshold_of(scan, field_of<SumField>({{{0, 0, 0}, 10}})), 99 * 10.0 / 100);
  EXPECT_EQ(threshold_of(scan, SumField{}), std::nullopt);
  // Without any zero the lowest value is 10.
  EXPECT_EQ(threshold_of(scan_of({{0, 0, 0}, {1, 0, 0}}),
                         field_of<SumField>({{{0, 0, 0}, 10}, {{1, 0, 0}, 110}})),
            109.0);
}

VoxelSet select_dynamic(const VoxelizedScan& scan, const SumField& sums,
                        std::optional<double> threshold, const VoxelSet& carried,
                        int min_otsu_score) {
  ThreadPool pool(2);
  return dilate_occupied(scan, above_threshold(scan, sums, threshold, carried, min_otsu_score),
                         pool);
}

TEST(SelectDynamic, TakesSumsStrictlyAboveTheThresholdAndDilatesOnce) {
  const Triples occupied{{7, 0, 0}, {8, 0, 0}, {9, 0, 0}, {30, 0, 0}};
  const VoxelizedScan scan = scan_of(occupied, {{6, 0, 0}});
  const SumField sums = field_of<SumField>({{{7, 0, 0}, 6}, {{9, 0, 0}, 5}, {{30, 0, 0}, 5}});
  EXPECT_EQ(triples(select_dynamic(scan, sums, 5.0, {}, 3)), (Triples{{7, 0, 0}, {8, 0, 0}}));
}

TEST(SelectDynamic, CarriedVoxelsStayWhileTheirSumExceedsTheMinimum) {
  const Triples occupied{{0, 0, 0}, {10, 0, 0}, {20, 0, 0}};
  const VoxelizedScan scan = scan_of(occupied);
  const SumField sums = field_of<SumField>({{{0, 0, 0}, 4}, {{10, 0, 0}, 3}, {{20, 0, 0}, 4}});
  const VoxelSet carried = voxel_set({{0, 0, 0}, {10, 0, 0}, {50, 0, 0}});
  EXPECT_EQ(triples(select_dynamic(scan, sums, 5.0, carried, 3)), (Triples{{0, 0, 0}}));
  EXPECT_EQ(triples(select_dynamic(scan, sums, std::nullopt, carried, 3)), (Triples{{0, 0, 0}}));
  EXPECT_TRUE(triples(select_dynamic(scan, sums, std::nullopt, {}, 3)).empty());
}

TEST(SelectDynamic, EqualsTheTwinOnRandomScans) {
  std::mt19937 random(72);
  std::size_t found = 0, carried_over = 0;
  for (int round = 0; round < 60; ++round) {
    const Triples occupied = random_triples(random, 500, 12);
    Sums sums;
    for (const Triple& v : occupied) {
      if (random() % 6 == 0) sums[v] = static_cast<int>(random() % 12);
    }
    const Triples carried = random_triples(random, 400, 12);
    const std::optional<double> threshold =
        round % 5 == 0 ? std::nullopt : std::optional(static_cast<double>(random() % 110) / 10);
    Triples selected;
    for (const auto& [v, sum] : sums) {
      const bool above = threshold && sum > *threshold;
      const bool kept = carried.contains(v) && sum > 3;
      if (above || kept) selected.insert(v);
      carried_over += kept && !above;
    }
    const Triples result = triples(select_dynamic(scan_of(occupied), field_of<SumField>(sums),
                                                  threshold, voxel_set(carried), 3));
    ASSERT_EQ(result, dilated(selected, occupied));
    found += result.size();
  }
  EXPECT_GT(found, 1000U);
  EXPECT_GT(carried_over, 20U);
}

/// Points in the voxels (101, 0, 0), none, (0, 0, 0), (100, 0, 0) and again (101, 0, 0).
VoxelizedScan scan_of_five_points() {
  VoxelizedScan scan = scan_of({{0, 0, 0}, {100, 0, 0}, {101, 0, 0}});
  const auto number = [&](const Triple& v) {
    const Voxel voxel{v[0], v[1], v[2]};
    return scan.measured.find(block_of(voxel)) * kBlockVoxels + cell_of(voxel);
  };
  scan.voxel_of_point = {number({101, 0, 0}), kNoVoxel, number({0, 0, 0}), number({100, 0, 0}),
                         number({101, 0, 0})};
  return scan;
}

TEST(ProjectScores, PointsTakeTheSumOverTheWindowAtTheirVoxel) {
  const VoxelizedScan scan = scan_of_five_points();
  LocalWindow window(2);
  window.join(field_of<VoteField>({{{101, 0, 0}, 1000}}));
  window.join(field_of<VoteField>({{{101, 0, 0}, 40}, {{100, 0, 0}, 7}, {{102, 0, 0}, 9}}));
  window.join(field_of<VoteField>({{{101, 0, 0}, 2}}));
  EXPECT_EQ(hmm_mos::project_scores(scan, window.sums(scan)),
            (std::vector<float>{42, 0, 0, 7, 42}));
  EXPECT_EQ(hmm_mos::project_scores(scan, {}), std::vector<float>(5, 0));
}

TEST(ProjectLabels, PointsTakeTheLabelOfTheirVoxel) {
  VoxelizedScan scan = scan_of_five_points();
  EXPECT_EQ(project_labels(scan, voxel_set({{101, 0, 0}})),
            (std::vector<std::uint32_t>{251, 9, 9, 9, 251}));
  EXPECT_EQ(project_labels(scan, VoxelSet{}), std::vector<std::uint32_t>(5, 9));
  scan.voxel_of_point.clear();
  EXPECT_TRUE(project_labels(scan, voxel_set({{101, 0, 0}})).empty());
}

}  // namespace
}  // namespace mosbench
