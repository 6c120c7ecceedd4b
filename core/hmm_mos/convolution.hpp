#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/voxel_map.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns K_m * P'_chg at the occupied voxels of the scan (paper, III): the number of changed,
/// occupied voxels among the m^3 around each, less one for each voxel that is not known (the
/// authors' program; the paper does not mention it), at least 0. `changed` are the changes that
/// count for this scan; `map` is refreshed where it is asked.
ScoreField convolve(const VoxelizedScan& scan, const VoxelSet& changed, int kernel_width_voxels,
                    VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool);

/// Returns the occupied voxels with an unknown voxel among the m^3 around them, as far as they lie
/// in or next to a block of either list. The authors' program keeps them out of the dynamic region.
VoxelSet beside_unknown(const VoxelizedScan& scan, std::span<const BlockIndex> blocks,
                        std::span<const BlockIndex> more_blocks, int kernel_width_voxels,
                        VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool);

/// Returns the slots of scan.measured of the given blocks and of all their neighbours, without
/// repeats.
std::vector<std::uint32_t> slots_around(const VoxelizedScan& scan,
                                        std::span<const BlockIndex> blocks);

/// Those of them that may have a voxel within `radius` per axis of one of `voxels`.
std::vector<std::uint32_t> slots_within(const VoxelizedScan& scan, const VoxelSet& voxels,
                                        int radius);

}  // namespace mosbench::hmm_mos
