#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// Widest halo: within the 26 blocks around.
inline constexpr int kMaxHalo = kBlockSide;

/// A block and `radius` voxels around it as rows along x: bit i of row (z, y) is the voxel
/// (i - radius, y - radius, z - radius) of the block.
struct HaloRows {
  static constexpr int kStride = 3 * kBlockSide;  // whole blocks along y, gathered eight at a time

  int radius = 0;
  int side = 0;  ///< 8 + 2 radius
  bool any = false;

  std::uint32_t row(int z, int y) const {
    return rows[static_cast<std::size_t>(z * kStride + kBlockSide - radius + y)];
  }

  /// Rows at -8 to 15 along y; z from -radius. Those beyond the halo along y hold anything.
  alignas(32) std::array<std::uint32_t, std::size_t{kStride} * kStride> rows;
};

/// Returns which of a block and its 26 neighbours (bits in the order of for_each_neighbour) may
/// have a voxel within `radius` per axis of one of the mask's. `radius` from 0 to kMaxHalo.
std::uint32_t blocks_within(const BlockMask& mask, int radius);

/// Gathers the masks of a block and its 26 neighbours, null ones as empty. `radius` from 0 to
/// kMaxHalo.
void gather_halo(const Neighbourhood& masks, int radius, HaloRows& halo);

/// Returns in `closed`, whose radius is less by `gap`, the halo and what lies between two of its
/// voxels of a column with at most `gap` voxels between them.
void close_columns(const HaloRows& halo, int gap, HaloRows& closed);

/// Inverts the halo.
void invert(HaloRows& halo);

/// Returns the voxels of the block that have a set voxel within `radius` per axis.
BlockMask dilate(const HaloRows& halo);

/// Returns the voxels of a block that have one of the mask's within it among themselves and their
/// 26 neighbours: what can be said of `dilate` with radius 1 without the blocks around.
BlockMask grown_inside(const BlockMask& mask);

/// Counts the set voxels in the cube of side 2 radius + 1 around a cell of the block.
int count_around(const HaloRows& halo, std::uint32_t cell);

}  // namespace mosbench
