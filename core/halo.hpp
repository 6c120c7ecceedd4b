#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel_set.hpp"

namespace mosbench {

/// Widest halo: a row of 8 + 2 * 28 voxels fills a word.
inline constexpr int kMaxHalo = 28;

/// A block and `radius` voxels around it as rows along x: bit i of row (z, y) is the voxel
/// (i - radius, y - radius, z - radius) of the block.
struct HaloRows {
  int radius = 0;
  int side = 0;  ///< 8 + 2 radius
  bool any = false;

  std::uint64_t row(int z, int y) const {
    return rows[static_cast<std::size_t>(z * stride + first + y)];
  }

  // Storage: rows of whole blocks along y, so that they are gathered eight at a time.
  int stride = 0, first = 0;
  std::vector<std::uint64_t> rows;
};

/// Blocks per direction that a halo is gathered from: those it reaches into, and at least one, so
/// that a Neighbourhood serves every radius up to 8.
inline int reach_of_halo(int radius) {
  return radius == 0 ? 1 : (radius + kBlockSide - 1) / kBlockSide;
}

/// Gathers the cube of (2 reach + 1)^3 masks around a block, x fastest; null ones count as empty.
void gather_halo(std::span<const BlockMask* const> masks, int radius, HaloRows& halo);

/// The voxels of the block that have a set voxel within `radius` per axis.
BlockMask dilate(const HaloRows& halo);

/// Set voxels in the cube of side 2 radius + 1 around a cell of the block.
int count_around(const HaloRows& halo, std::uint32_t cell);

}  // namespace mosbench
