#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/halo.hpp"
#include "core/voxel/voxelize.hpp"

/// Blocks of a scan, by their slots in scan.measured, and the voxels around them.
namespace mosbench {

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
