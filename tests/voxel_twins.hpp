#pragma once

#include <array>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

/// Voxels as plain ordered triples, for twins that share no code with the blocks and masks of core.
namespace mosbench {

using Triple = std::array<int, 3>;
using Triples = std::set<Triple>;

inline Triple triple(const Voxel& v) { return {v.x, v.y, v.z}; }

/// Block index and cell by division and remainder of non-negative numbers.
inline void set_voxel(VoxelSet& set, const Triple& v) {
  const auto block = [](int c) { return (c + 8000) / 8 - 1000; };
  const auto inner = [](int c) { return static_cast<std::uint32_t>((c + 8000) % 8); };
  const std::uint32_t slot = set.insert({block(v[0]), block(v[1]), block(v[2])});
  set.masks[slot].set(inner(v[2]) * 64 + inner(v[1]) * 8 + inner(v[0]));
}

inline VoxelSet voxel_set(const Triples& voxels) {
  VoxelSet set;
  for (const Triple& v : voxels) set_voxel(set, v);
  return set;
}

inline Triples triples(std::span<const BlockIndex> blocks, std::span<const BlockMask> masks) {
  Triples voxels;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::uint32_t cell = 0; cell < 512; ++cell) {
      if (!masks[i].test(cell)) continue;
      voxels.insert({blocks[i].x * 8 + static_cast<int>(cell % 8),
                     blocks[i].y * 8 + static_cast<int>(cell / 8 % 8),
                     blocks[i].z * 8 + static_cast<int>(cell / 64)});
    }
  }
  return voxels;
}

inline Triples triples(const VoxelSet& set) { return triples(set.blocks, set.masks); }

/// A scan whose occupied voxels are those given; `only_measured` ones are beyond the range.
inline VoxelizedScan scan_of(const Triples& occupied, const Triples& only_measured = {}) {
  VoxelizedScan scan;
  scan.measured = voxel_set(occupied);
  for (const Triple& v : only_measured) set_voxel(scan.measured, v);
  const VoxelSet in_range = voxel_set(occupied);
  for (const BlockIndex& block : scan.measured.blocks) {
    const BlockMask* mask = in_range.mask_of(block);
    scan.occupied.push_back(mask == nullptr ? BlockMask{} : *mask);
  }
  scan.occupied_count = occupied.size();
  return scan;
}

/// `count` voxels, not all of them different, with coordinates from -reach to reach - 1.
inline Triples random_triples(std::mt19937& random, std::size_t count, int reach) {
  Triples voxels;
  const auto coordinate = [&] {
    return static_cast<int>(random() % static_cast<unsigned>(2 * reach)) - reach;
  };
  for (std::size_t i = 0; i < count; ++i) voxels.insert({coordinate(), coordinate(), coordinate()});
  return voxels;
}

/// Calls visit(neighbour) for the cube of side 2 radius + 1 around a voxel.
template <typename Visit>
void for_cube(const Triple& v, int radius, Visit&& visit) {
  for (int x = v[0] - radius; x <= v[0] + radius; ++x) {
    for (int y = v[1] - radius; y <= v[1] + radius; ++y) {
      for (int z = v[2] - radius; z <= v[2] + radius; ++z) visit(Triple{x, y, z});
    }
  }
}

/// The value of a SparseField at a voxel; 0 where the block is absent.
template <typename Field>
int value_at(const Field& field, const Triple& v) {
  const Voxel voxel{v[0], v[1], v[2]};
  const auto* block = field.find(block_of(voxel));
  return block == nullptr ? 0 : static_cast<int>((*block)[cell_of(voxel)]);
}

}  // namespace mosbench
