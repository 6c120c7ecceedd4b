#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

/// Blocks of a scan, by their slots in scan.measured, and the voxels around them.
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

/// Returns the slots of the given blocks and of all their neighbours, without repeats.
std::vector<std::uint32_t> slots_around(const VoxelizedScan& scan,
                                        std::span<const BlockIndex> blocks);

/// Returns the slots of blocks that may have a voxel within `radius` per axis of one of `seeds`,
/// without repeats.
std::vector<std::uint32_t> slots_within(const VoxelizedScan& scan, const VoxelSet& seeds,
                                        int radius);

/// Returns the blocks of these slots.
std::vector<BlockIndex> blocks_of(const VoxelizedScan& scan, std::span<const std::uint32_t> slots);

/// Gathers the voxels of a set in a block and its 26 neighbours.
void gather_around(const VoxelSet& voxels, const BlockIndex& block, int radius, HaloRows& rows);

/// Calls visit(i, rows, reach) for every slots[i], on several threads: `rows` are the seeds in and
/// around that block, `reach` its occupied voxels within `radius` per axis of a seed.
template <typename Visit>
void for_each_block_near(const VoxelSet& seeds, int radius, const VoxelizedScan& scan,
                         std::span<const std::uint32_t> slots, ThreadPool& pool, Visit&& visit) {
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows;
    for (std::size_t i = begin; i < end; ++i) {
      gather_around(seeds, scan.measured.blocks[slots[i]], radius, rows);
      visit(i, rows, dilate(rows) & scan.occupied[slots[i]]);
    }
  });
}

/// Returns the voxels masks[i] of the blocks slots[i].
VoxelSet set_of(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                std::span<const BlockMask> masks);

}  // namespace mosbench
