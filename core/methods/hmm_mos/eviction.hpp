#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/methods/hmm_mos/config.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos {

/// Blocks first_slot, first_slot + stride, ... lose their voxels that are out of range of one of
/// the positions [first_position, last_position).
struct Sweep {
  std::uint32_t first_slot, stride;
  std::size_t first_position, last_position;
};

/// Decides when voxels out of range leave the map (paper, III; the radius is the authors'
/// program's: 2 ranges, in release-2025 1.5).
///
/// Eviction is amortised: each scan sweeps one block in kSweepScans, against the last kSweepScans
/// positions. Nobody can see the difference while
///   path(kSweepScans + n) <= evict_radius - asked,
/// the path of the sensor over the last kSweepScans + n scans. For a voxel that should have left
/// lay farther than evict_radius from a position since the last sweep of its block. What is asked
/// about scan k, or later about scan k - n, lies within `asked` = max_range + kernel of a position
/// of that path, so it lies nearer than asked + path <= evict_radius to each of these positions:
/// such a voxel is never asked about before the next sweep of its block removes it. Nor is it
/// observed again, as rays end at max_range. While the path is longer, every scan sweeps all blocks
/// against its own position; when it becomes so, what the positions before should have evicted goes
/// first.
class Eviction {
 public:
  static constexpr std::uint32_t kSweepScans = 16;

  Eviction(const Config& config, const VoxelGrid& grid);

  /// Takes the position of a scan before it enters the map. Returns the sweep to do before.
  std::optional<Sweep> enter(const Eigen::Vector3d& sensor_m);

  /// Returns the sweep to do after the scan has entered.
  Sweep sweep_after(std::uint32_t scan_index) const;

  /// Returns the voxels that are in range of all positions of the sweep.
  BlockMask within(const Sweep& sweep, const BlockIndex& block, BlockMask voxels) const;

 private:
  VoxelGrid grid_;
  double evict_radius_m_, safe_path_m_;
  std::size_t positions_kept_;
  std::deque<Eigen::Vector3d> sensors_m_;  // the last ones, current one last
  bool fast_ = false;                      // the path is longer than safe_path_m_
};

}  // namespace mosbench::hmm_mos
