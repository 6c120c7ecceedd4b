#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/methods/hmm_mos/config.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos {

/// The index of the scan in which each voxel of a block was seen last, modulo 2^planes: what w_g
/// (paper, III) is compared with. Bit p of all 512 numbers fills one mask, so that all numbers are
/// written or compared with a few operations per bit instead of some per voxel. The upper bits are
/// the same for eight scans and written after these.
class LastSeen {
 public:
  static constexpr int kMaxPlanes = 16;
  static constexpr int kLowPlanes = 3;  ///< written by every stamp
  /// Bytes from the beginning that most stamps touch.
  static constexpr std::size_t kTouchedBytes = (2 + kLowPlanes) * sizeof(BlockMask);
  /// Returns how many planes distinguish ages up to `max_age`.
  static int planes_for(std::uint32_t max_age);

  void stamp(const BlockMask& voxels, std::uint32_t scan_index, int planes);

  /// Ages at one scan, in the same form.
  class Ages {
   public:
    Ages(const LastSeen& last_seen, std::uint32_t scan_index, int planes);
    BlockMask at_least(std::uint32_t age) const;
    /// The greatest age among `voxels`; 0 when there is none.
    std::uint32_t greatest(const BlockMask& voxels) const;

   private:
    std::array<BlockMask, kMaxPlanes> bits_;
    int planes_;
  };

 private:
  std::uint32_t upper_ = 0;  ///< the scan index without its low bits, of the last stamp
  BlockMask recent_;         ///< stamped since that changed: their upper bits are not written yet
  std::array<BlockMask, kMaxPlanes> bits_;
};

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

  /// Rays may start this far from the positions: what is asked lies farther away by it.
  void expect_rays_from(double distance_m) { rays_from_m_ = std::max(rays_from_m_, distance_m); }

  /// Takes the position of a scan before it enters the map. Returns the sweep to do before.
  std::optional<Sweep> enter(const Eigen::Vector3d& sensor_m);

  /// Returns the sweep to do after the scan has entered.
  Sweep sweep_after(std::uint32_t scan_index) const;

  /// Returns the voxels that are in range of all positions of the sweep.
  BlockMask within(const Sweep& sweep, const BlockIndex& block, BlockMask voxels) const;

 private:
  VoxelGrid grid_;
  double evict_radius_m_, safe_path_m_;
  double rays_from_m_ = 0;
  std::size_t positions_kept_;
  std::deque<Eigen::Vector3d> sensors_m_;  // the last ones, current one last
  bool fast_ = false;                      // the path is longer than safe_path_m_
};

}  // namespace mosbench::hmm_mos
