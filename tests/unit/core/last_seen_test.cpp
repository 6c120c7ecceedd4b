#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/methods/hmm_mos/global_window.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

BlockMask random_mask(std::mt19937& random) {
  BlockMask mask;
  for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
    if (random() % 7 == 0) mask.set(cell);
  }
  return mask;
}

/// The same with a number for each voxel.
struct Numbers {
  LastSeen last_seen;
  std::vector<std::uint32_t> of_cell = std::vector<std::uint32_t>(kBlockVoxels);

  void stamp(const BlockMask& voxels, std::uint32_t scan, int planes) {
    last_seen.stamp(voxels, scan, planes);
    for_each_cell(voxels, [&](std::uint32_t cell) { of_cell[cell] = scan; });
  }
};

TEST(LastSeen, TellsAgesAsAListOfNumbersDoes) {
  std::mt19937 random(7);
  for (const std::uint32_t oldest : {5u, 63u, 700u, 60064u}) {
    const int planes = LastSeen::planes_for(oldest);
    ASSERT_LE(planes, LastSeen::kMaxPlanes);
    ASSERT_GE(std::uint32_t{1} << planes, oldest + 1);
    Numbers numbers;
    // What the block that had this memory before has left.
    for (std::uint32_t scan = 0; scan < 40; scan += 3) {
      numbers.stamp(random_mask(random), scan, planes);
    }
    // Over the wrap of the planes, and over borders of the upper bits with many stamps in between.
    const std::uint32_t wrap = 3 * (std::uint32_t{1} << planes), first = wrap - oldest / 2;
    std::uint32_t scan = first;
    numbers.stamp(~BlockMask{}, scan, planes);
    while (scan < first + oldest / 5 * 4) {
      const std::uint32_t step = random() % 4 == 0 ? oldest / 8 : 1;
      scan = std::min(scan + step, first + oldest / 5 * 4);
      const BlockMask seen = random_mask(random);
      ASSERT_GT(seen.count(), 20u);
      numbers.stamp(seen, scan, planes);
    }
    ASSERT_GT(scan, wrap);
    scan += oldest / 5;

    const LastSeen::Ages ages(numbers.last_seen, scan, planes);
    for (const std::uint32_t age :
         {0u, 1u, oldest / 5, oldest / 5 + 1, oldest, oldest + 1, 70000u}) {
      const BlockMask old = ages.at_least(age);
      for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
        ASSERT_EQ(old.test(cell), scan - numbers.of_cell[cell] >= age)
            << "age " << age << " cell " << cell;
      }
    }
    const BlockMask some = random_mask(random);
    std::uint32_t greatest = 0;
    for_each_cell(some, [&](std::uint32_t cell) {
      greatest = std::max(greatest, scan - numbers.of_cell[cell]);
    });
    EXPECT_EQ(ages.greatest(some), greatest);
    EXPECT_EQ(ages.greatest({}), 0u);
  }
}

}  // namespace
}  // namespace mosbench
