#include "core/distance_field.hpp"

#include <gtest/gtest.h>

#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

/// Any number that stands for "none" where no source is within the radius.
BlockDistances distances_in_block_zero(const Triples& sources, const DistanceField& field) {
  const VoxelSet set = voxel_set(sources);
  const BlockMask empty;
  const int reach = field.reach();
  std::vector<const BlockMask*> masks;
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const BlockMask* mask = set.mask_of({x, y, z});
        masks.push_back(mask == nullptr ? &empty : mask);
      }
    }
  }
  BlockDistances distances;
  if (!field.squared_distances(masks, distances)) distances.fill(0xFFFF);
  return distances;
}

TEST(DistanceField, EqualsAllPairsWithinItsRadius) {
  std::mt19937 random(33);
  std::size_t near = 0, far = 0;
  for (int radius = 0; radius <= kMaxDistanceRadius; ++radius) {
    const DistanceField field(radius);
    ASSERT_EQ(field.radius(), radius);
    for (const std::size_t count : {0U, 1U, 2U, 8U, 60U, 600U}) {
      const Triples sources = random_triples(random, count, radius + 10);
      const BlockDistances distances = distances_in_block_zero(sources, field);
      for (std::uint32_t cell = 0; cell < 512; ++cell) {
        const Triple here = triple(voxel_at({0, 0, 0}, cell));
        int best = 1'000'000;
        for (const Triple& s : sources) {
          const int dx = s[0] - here[0], dy = s[1] - here[1], dz = s[2] - here[2];
          best = std::min(best, dx * dx + dy * dy + dz * dz);
        }
        const int exact_below = (radius + 1) * (radius + 1);
        if (best < exact_below) {
          ASSERT_EQ(distances[cell], best) << "radius " << radius << " cell " << cell;
          ++near;
        } else {
          ASSERT_GE(distances[cell], exact_below) << "radius " << radius << " cell " << cell;
          ++far;
        }
      }
    }
  }
  EXPECT_GT(near, 10'000U);
  EXPECT_GT(far, 10'000U);
}

TEST(DistanceField, SourceAtTheRimOfTheRadiusIsSeenAlongEachAxis) {
  for (const int radius : {1, 5, 8, 14, 15, 28}) {
    const DistanceField field(radius);
    const int far = radius * radius;
    EXPECT_EQ(distances_in_block_zero({{-radius, 0, 0}}, field)[0], far);
    EXPECT_EQ(distances_in_block_zero({{0, -radius, 0}}, field)[0], far);
    EXPECT_EQ(distances_in_block_zero({{0, 0, -radius}}, field)[0], far);
    EXPECT_EQ(distances_in_block_zero({{7 + radius, 7, 7}}, field)[511], far);
    EXPECT_EQ(distances_in_block_zero({{7, 7 + radius, 7}}, field)[511], far);
    EXPECT_EQ(distances_in_block_zero({{7, 7, 7 + radius}}, field)[511], far);
  }
}

TEST(DistanceField, CellsBelowALimitAreThoseOfTheLoop) {
  std::mt19937 random(35);
  for (const std::size_t limit : {1U, 36U, 37U, 255U, 840U}) {
    BlockDistances distances;
    for (auto& distance : distances) {
      distance = static_cast<std::uint16_t>(random() % 3 == 0 ? limit : random() % (2 * limit));
    }
    const BlockMask below = cells_below(distances, limit);
    EXPECT_TRUE(below.any());
    for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
      ASSERT_EQ(below.test(cell), distances[cell] < limit) << "limit " << limit;
    }
  }
}

}  // namespace
}  // namespace mosbench
