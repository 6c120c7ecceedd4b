#pragma once

#include <cstddef>
#include <deque>

#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

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
