#include <gtest/gtest.h>

#include "core/voxel/neighbourhood.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

/// The halo of block (0, 0, 0).
HaloRows halo_of(const VoxelSet& set, int radius) {
  Neighbourhood masks;
  for_each_neighbour({0, 0, 0}, [&](std::size_t position, const BlockIndex& block) {
    masks[position] = set.mask_of(block);
  });
  HaloRows halo;
  gather_halo(masks, radius, halo);
  return halo;
}

/// Few voxels or many, in the block alone or all around.
Triples voxels_around(std::mt19937& random, int radius) {
  const std::size_t count = random() % 2 == 0 ? 5 : 300;
  Triples voxels = random_triples(random, count, radius + 10);
  if (random() % 4 == 0) voxels.clear();
  return voxels;
}

TEST(Halo, RowsHoldEveryVoxelWithinTheRadius) {
  std::mt19937 random(31);
  for (int radius = 0; radius <= kMaxHalo; ++radius) {
    for (int round = 0; round < 4; ++round) {
      const Triples voxels = voxels_around(random, radius);
      const HaloRows halo = halo_of(voxel_set(voxels), radius);
      ASSERT_EQ(halo.side, 8 + 2 * radius);
      bool any = false;
      for (int z = 0; z < halo.side; ++z) {
        for (int y = 0; y < halo.side; ++y) {
          std::uint32_t row = 0;
          for (int x = 0; x < halo.side; ++x) {
            const bool set = voxels.contains({x - radius, y - radius, z - radius});
            row |= std::uint32_t{set} << x;
          }
          ASSERT_EQ(halo.row(z, y), row) << "radius " << radius << " z " << z << " y " << y;
          any |= row != 0;
        }
      }
      EXPECT_EQ(halo.any, any);
    }
  }
}

TEST(Halo, DilationAndCountEqualTheTripleLoop) {
  std::mt19937 random(32);
  std::size_t counted = 0;
  for (int radius = 0; radius <= kMaxHalo; ++radius) {
    for (int round = 0; round < (radius < 8 ? 8 : 1); ++round) {
      const Triples voxels = voxels_around(random, radius);
      const HaloRows halo = halo_of(voxel_set(voxels), radius);
      const BlockMask dilated = dilate(halo);
      for (std::uint32_t cell = 0; cell < 512; ++cell) {
        const Triple here = triple(voxel_at({0, 0, 0}, cell));
        int count = 0;
        for (const Triple& v : voxels) {
          count += std::abs(v[0] - here[0]) <= radius && std::abs(v[1] - here[1]) <= radius &&
                   std::abs(v[2] - here[2]) <= radius;
        }
        ASSERT_EQ(count_around(halo, cell), count) << "radius " << radius << " cell " << cell;
        ASSERT_EQ(dilated.test(cell), count > 0) << "radius " << radius << " cell " << cell;
        counted += count > 0;
      }
    }
  }
  EXPECT_GT(counted, 10'000U);
}

TEST(Halo, ClosingColumnsFillsWhatLiesBetweenTwoVoxelsThatAreNear) {
  std::mt19937 random(33);
  std::size_t filled = 0;
  for (int gap = 0; gap <= kMaxHalo; ++gap) {
    const Triples voxels = random_triples(random, 2000, 10);
    HaloRows closed;
    close_columns(halo_of(voxel_set(voxels), kMaxHalo), gap, closed);
    Triples expected = voxels;
    for (const Triple& low : voxels) {
      for (int height = 2; height <= gap + 1; ++height) {
        if (!voxels.contains({low[0], low[1], low[2] + height})) continue;
        for (int dz = 1; dz < height; ++dz) expected.insert({low[0], low[1], low[2] + dz});
      }
    }
    filled += expected.size() - voxels.size();
    const HaloRows other = halo_of(voxel_set(expected), kMaxHalo - gap);
    ASSERT_EQ(closed.radius, other.radius);
    ASSERT_EQ(closed.side, other.side);
    ASSERT_EQ(closed.any, other.any);
    for (int z = 0; z < other.side; ++z) {
      for (int y = 0; y < other.side; ++y) ASSERT_EQ(closed.row(z, y), other.row(z, y)) << gap;
    }
  }
  EXPECT_GT(filled, 100U);
}

TEST(Halo, InvertingTurnsOverEveryVoxelOfTheHalo) {
  std::mt19937 random(34);
  for (int radius = 0; radius <= kMaxHalo; ++radius) {
    const Triples voxels = voxels_around(random, radius);
    HaloRows halo = halo_of(voxel_set(voxels), radius);
    const int width = 2 * radius + 1;
    const HaloRows before = halo;
    invert(halo);
    EXPECT_TRUE(halo.any);
    for (std::uint32_t cell = 0; cell < 512; ++cell) {
      ASSERT_EQ(count_around(halo, cell), width * width * width - count_around(before, cell));
    }
  }
}

TEST(Halo, BlocksWithinTheRadiusHaveAVoxelOfTheBoxAround) {
  std::mt19937 random(36);
  std::size_t left_out = 0;
  for (int radius = 0; radius <= kMaxHalo; ++radius) {
    for (int round = 0; round < 20; ++round) {
      BlockMask mask;
      for (unsigned i = 0; i < random() % 4; ++i) mask.set(random() % kBlockVoxels);
      const std::uint32_t reached = blocks_within(mask, radius);
      Triple low{8, 8, 8}, high{-1, -1, -1};
      for_each_cell(mask, [&](std::uint32_t cell) {
        const Triple here = triple(voxel_at({0, 0, 0}, cell));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], here[axis]);
          high[axis] = std::max(high[axis], here[axis]);
        }
      });
      for_each_neighbour({0, 0, 0}, [&](std::size_t position, const BlockIndex& block) {
        const Triple first = triple(voxel_at(block, 0));
        bool meets = mask.any();
        for (std::size_t axis = 0; axis < 3; ++axis) {
          meets =
              meets && first[axis] <= high[axis] + radius && first[axis] + 7 >= low[axis] - radius;
        }
        ASSERT_EQ(reached >> position & 1u, meets ? 1u : 0u) << radius << ' ' << position;
        left_out += mask.any() && !meets;
      });
    }
  }
  EXPECT_GT(left_out, 1000U);
}

TEST(Halo, RadiusZeroIsTheBlockItself) {
  const HaloRows halo = halo_of(voxel_set({{0, 0, 0}, {7, 7, 7}, {-1, 0, 0}, {8, 7, 7}}), 0);
  EXPECT_EQ(count_around(halo, 0), 1);
  EXPECT_EQ(count_around(halo, 511), 1);
  EXPECT_EQ(dilate(halo).count(), 2U);
}

}  // namespace
}  // namespace mosbench
