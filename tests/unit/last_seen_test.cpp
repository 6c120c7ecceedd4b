#include "core/last_seen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace mosbench {
namespace {

BlockMask random_mask(std::mt19937& random) {
  BlockMask mask;
  for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
    if (random() % 7 == 0) mask.set(cell);
  }
  return mask;
}

TEST(LastSeen, TellsAgesAsAListOfNumbersDoes) {
  std::mt19937 random(7);
  for (const std::uint32_t oldest : {5u, 63u, 700u, 60064u}) {
    const int planes = LastSeen::planes_for(oldest);
    ASSERT_LE(planes, LastSeen::kMaxPlanes);
    ASSERT_GE(std::uint32_t{1} << planes, oldest + 1);
    LastSeen last_seen;
    std::vector<std::uint32_t> numbers(kBlockVoxels);
    // Beyond the wrap of the planes.
    std::uint32_t scan = 3 * oldest + 1;
    for (std::uint32_t& number : numbers) number = scan;
    last_seen.stamp(~BlockMask{}, scan, planes);
    const std::uint32_t last = scan + oldest / 5 * 4;
    while (scan < last) {
      // Steps within and over the eight scans of the same upper bits.
      scan += oldest < 64 ? static_cast<std::uint32_t>(random() % 4) : oldest / 5;
      scan = std::min(scan, last);
      const BlockMask seen = random_mask(random);
      ASSERT_GT(seen.count(), 20u);
      last_seen.stamp(seen, scan, planes);
      for_each_cell(seen, [&](std::uint32_t cell) { numbers[cell] = scan; });
    }
    scan += oldest / 5;

    const LastSeen::Ages ages(last_seen, scan, planes);
    for (const std::uint32_t age :
         {0u, 1u, oldest / 5, oldest / 5 + 1, oldest, oldest + 1, 70000u}) {
      const BlockMask old = ages.at_least(age);
      for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
        ASSERT_EQ(old.test(cell), scan - numbers[cell] >= age) << "age " << age << " cell " << cell;
      }
    }
    const BlockMask some = random_mask(random);
    std::uint32_t greatest = 0;
    for_each_cell(some,
                  [&](std::uint32_t cell) { greatest = std::max(greatest, scan - numbers[cell]); });
    EXPECT_EQ(ages.greatest(some), greatest);
    EXPECT_EQ(ages.greatest({}), 0u);
  }
}

}  // namespace
}  // namespace mosbench
