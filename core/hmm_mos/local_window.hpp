#pragma once

#include <cstddef>
#include <deque>

#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// The filtered scores of the last w_l scans.
class LocalWindow {
 public:
  explicit LocalWindow(int scans) : scans_(static_cast<std::size_t>(scans)) {}

  /// algorithm step 5c: a scan joins, the oldest leaves.
  void join(ScoreField scores);

  /// S(v): the sum over the window at the occupied voxels of the scan.
  SumField sums(const VoxelizedScan& scan) const;

  std::size_t memory_bytes() const;

 private:
  std::size_t scans_;
  std::deque<ScoreField> window_;
};

}  // namespace mosbench::hmm_mos
