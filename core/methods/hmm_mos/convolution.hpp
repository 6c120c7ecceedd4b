#pragma once

#include <cstdint>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns the radius of a kernel K_m of odd width m.
constexpr int radius_of(int kernel_width_voxels) { return (kernel_width_voxels - 1) / 2; }

/// Returns K_m * P'_chg at the occupied voxels of the scan (paper, III): the number of `changed`
/// voxels among the m^3 around each, less one for each voxel that is not known (the authors'
/// program; the paper does not mention it), at least 0. `changed` are occupied voxels of the scan,
/// `slots` are slots_within(scan, changed, radius), and `known` must be complete in and next to
/// these blocks.
VoteField convolve(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                   const VoxelSet& changed, const VoxelSet& known, int kernel_width_voxels,
                   ThreadPool& pool);

/// Returns the occupied voxels of the blocks `slots` of the scan with an unknown voxel among the
/// m^3 around them; `known` must be complete in and next to these blocks. The authors' program
/// keeps them out of the dynamic region.
VoxelSet beside_unknown(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                        const VoxelSet& known, int kernel_width_voxels, ThreadPool& pool);

}  // namespace mosbench::hmm_mos
