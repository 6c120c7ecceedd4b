#include "core/voxel/distance_field.hpp"

#include <gtest/gtest.h>

#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

const BlockMask kAllCells = ~BlockMask{};

/// The cube of blocks around one.
struct Cube {
  Cube(const BlockIndex& block, const VoxelSet& set, int reach) {
    for (int z = -reach; z <= reach; ++z) {
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
          const BlockMask* mask = set.mask_of({block.x + x, block.y + y, block.z + z});
          blocks.emplace_back();
          if (mask != nullptr) blocks.back().add(*mask);
        }
      }
    }
    for (const SourceBlock& source : blocks) sources.push_back(&source);
  }

  std::vector<SourceBlock> blocks;
  std::vector<const SourceBlock*> sources;
};

BlockDistances distances_in_block_zero(const Triples& sources, const DistanceField& field) {
  const Cube cube({}, voxel_set(sources), field.reach());
  BlockDistances distances;
  ColumnDistances(field).find({}, kAllCells, cube.sources, distances);
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
        ASSERT_EQ(distances.near.test(cell), best < exact_below);
        if (best < exact_below) {
          ASSERT_EQ(distances.squared[cell], best) << "radius " << radius << " cell " << cell;
          ++near;
        } else {
          if (distances.near.words[cell / 64] != 0) {
            ASSERT_EQ(distances.squared[cell], exact_below);
          }
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
    EXPECT_EQ(distances_in_block_zero({{-radius, 0, 0}}, field).squared[0], far);
    EXPECT_EQ(distances_in_block_zero({{0, -radius, 0}}, field).squared[0], far);
    EXPECT_EQ(distances_in_block_zero({{0, 0, -radius}}, field).squared[0], far);
    EXPECT_EQ(distances_in_block_zero({{7 + radius, 7, 7}}, field).squared[511], far);
    EXPECT_EQ(distances_in_block_zero({{7, 7 + radius, 7}}, field).squared[511], far);
    EXPECT_EQ(distances_in_block_zero({{7, 7, 7 + radius}}, field).squared[511], far);
  }
}

/// Whatever the order of blocks and whichever layers were asked for before.
TEST(ColumnDistances, AreThoseOfEachBlockAlone) {
  std::mt19937 random(35);
  for (const int radius : {0, 1, 5, 6, 7, 14, 28}) {
    const DistanceField field(radius);
    const VoxelSet sources = voxel_set(random_triples(random, 3000, 40));
    ColumnDistances column(field);
    BlockDistances distances, alone;
    BlockIndex block;
    std::size_t above = 0, far_above = 0, higher_elsewhere = 0, near = 0;
    for (int i = 0; i < 400; ++i) {
      const BlockIndex last = block;
      // Mostly up by one, sometimes by more, down or not at all, and sometimes elsewhere.
      if (block.z > 12 || random() % 4 == 0) {
        block = {static_cast<int>(random() % 3) - 1, static_cast<int>(random() % 3) - 1,
                 static_cast<int>(random() % 11) - 5};
      } else {
        block.z += random() % 4 != 0 ? 1 : static_cast<int>(random() % 14) - 4;
      }
      const bool same_column = block.x == last.x && block.y == last.y;
      above += same_column && block.z == last.z + 1;
      far_above += same_column && (block.z - last.z) * kBlockSide >= kBlockSide + 2 * radius;
      higher_elsewhere += !same_column && block.z > last.z;
      BlockMask wanted;
      for (auto& word : wanted.words) word = random() % 3 == 0 ? 0 : random() + 1;
      const Cube cube(block, sources, field.reach());
      column.find(block, wanted, cube.sources, distances);
      ColumnDistances(field).find(block, kAllCells, cube.sources, alone);
      for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
        const bool in_layer = wanted.words[cell / 64] != 0;
        ASSERT_EQ(distances.near.test(cell), in_layer && alone.near.test(cell)) << radius;
        near += distances.near.test(cell);
        if (distances.near.words[cell / 64] == 0) continue;
        ASSERT_EQ(distances.squared[cell], alone.squared[cell]) << radius;
      }
    }
    EXPECT_GT(above, 50U);
    EXPECT_GT(far_above, 0U) << radius;
    EXPECT_GT(higher_elsewhere, 10U);
    EXPECT_GT(near, 100U);
  }
}

}  // namespace
}  // namespace mosbench
