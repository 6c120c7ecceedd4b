#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/voxel_map.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// algorithm step 5a: the spatial score of every occupied voxel of the scan, max(0, votes) over the
/// m^3 neighbours: +1 for an occupied voxel that changed, -1 for a voxel that is not known.
/// `changed` are the changes that count for this scan; `map` is refreshed where it is asked.
ScoreField convolve(const VoxelizedScan& scan, const VoxelSet& changed, int kernel_width_voxels,
                    VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool);

/// Occupied voxels in and beside the blocks of either list that have an unknown voxel among their
/// m^3 neighbours.
VoxelSet beside_unknown(const VoxelizedScan& scan, std::span<const BlockIndex> blocks,
                        std::span<const BlockIndex> more_blocks, int kernel_width_voxels,
                        VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool);

/// Slots of scan.measured of the given blocks and of all their neighbours, without repeats.
std::vector<std::uint32_t> slots_around(const VoxelizedScan& scan,
                                        std::span<const BlockIndex> blocks);

/// Those of them that may have a voxel within `radius` per axis of one of `voxels`.
std::vector<std::uint32_t> slots_within(const VoxelizedScan& scan, const VoxelSet& voxels,
                                        int radius);

}  // namespace mosbench::hmm_mos
