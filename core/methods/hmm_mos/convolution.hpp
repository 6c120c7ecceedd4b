#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"
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

/// The local window of the paper (III): the filtered votes of the last w_l scans, whose sum is the
/// dynamic score L^dyn = sum over w_l of K_m * P'_chg.
class LocalWindow {
 public:
  explicit LocalWindow(int scans) : scans_(static_cast<std::size_t>(scans)) {}

  /// Takes the votes of a scan in; those of the oldest scan leave.
  void join(VoteField votes);

  /// Returns L^dyn at the occupied voxels of the scan.
  SumField sums(const VoxelizedScan& scan) const;

  std::size_t memory_bytes() const;

 private:
  std::size_t scans_;
  std::deque<VoteField> window_;
};

}  // namespace mosbench::hmm_mos
