#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/base/slot_pool.hpp"
#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/config.hpp"
#include "core/hmm_mos/hmm.hpp"
#include "core/hmm_mos/last_seen.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::hmm_mos {

/// The map M of the paper (III): beliefs x, states S and ages of the voxels observed in the last
/// w_g scans within the eviction radius.
class VoxelMap {
 public:
  VoxelMap(const Config& config, const VoxelGrid& grid);

  /// One step x_k = eta B A x_{k-1} of the observed voxels, and their states (paper, III).
  /// `sources` are the measured sets whose union the distance field refers to; `sensor_m` is this
  /// scan's position. Returns the voxels whose state changed.
  VoxelList update(const VoxelList& observed, std::span<const VoxelSet* const> sources,
                   const Eigen::Vector3d& sensor_m, std::uint32_t scan_index, ThreadPool& pool);

  /// To be called after `update`: removes voxels that lie beyond the eviction radius of this scan's
  /// sensor or were not observed for more than w_g scans (paper, III). Eviction is amortised: a
  /// block is visited once in kSweepScans scans. Results are unchanged as long as the sensor moves
  /// less than safe_path_m_ meanwhile; otherwise all blocks are visited.
  void evict(std::uint32_t scan_index);

  /// Returns the known voxels at `scan_index`, those with a state that were observed less than w_g
  /// scans ago, of these blocks and all their neighbours. Not const, because ages are kept lazily
  /// and updated here.
  VoxelSet known_at(std::uint32_t scan_index, std::span<const BlockIndex> blocks, ThreadPool& pool);

  /// Voxels whose last change is at `first_scan` or later, by block.
  VoxelSet changed_since(std::uint32_t first_scan) const;

  std::size_t block_count() const { return blocks_.in_use(); }
  std::size_t memory_bytes() const;

 private:
  struct Block {
    BlockIndex index;
    std::uint32_t oldest_seen;  // lower bound of last_seen over voxels that age
    std::uint32_t newest_seen;
    bool live = false;
    BlockStates states;
    BlockMask seen;      // has a record
    BlockMask fresh;     // seen at newest_seen, not yet in last_seen
    BlockMask nonzero;   // has a number in beliefs
    BlockMask stale;     // not seen for w_g scans or more
    BlockMask ageless;   // release-2025: stale and never to expire
    LastSeen last_seen;  // last: most of it is seldom touched
  };
  struct ChangesOfScan {
    std::uint32_t scan_index;
    VoxelList voxels;
  };

  std::uint32_t add_block(const BlockIndex& index, std::uint32_t scan_index);
  void drop_block(std::uint32_t slot);
  void refresh_block(Block& block, std::uint32_t scan_index);
  void stamp_fresh(Block& block, const BlockMask& voxels);
  static void forget(Block& block, const BlockMask& voxels);
  void note_sensor(const Eigen::Vector3d& sensor_m, std::uint32_t scan_index);
  void sweep(std::uint32_t first_slot, std::uint32_t stride, std::size_t first_sensor,
             std::size_t last_sensor, std::uint32_t scan_index);
  void evict_from_block(std::uint32_t slot, std::size_t first_sensor, std::size_t last_sensor,
                        std::uint32_t scan_index);

  void drop_expired_changes(std::uint32_t scan_index);

  static constexpr std::uint32_t kSweepScans = 16;

  VoxelGrid grid_;
  Variant variant_;
  BeliefFilter filter_;
  DistanceField distance_field_;
  std::uint32_t global_window_scans_;
  int age_planes_;
  std::uint32_t delay_scans_;
  double evict_radius_m_;
  double safe_path_m_;
  BlockTable table_;
  SlotPool<Block> blocks_;
  SlotPool<BlockBeliefs> beliefs_;
  // Slot in beliefs_ by slot of the block, or kNoSlot while every belief is zero. Not in the block,
  // which the serial part of `update` would fetch from memory to ask.
  std::vector<std::uint32_t> beliefs_of_;
  std::deque<ChangesOfScan> changes_;  // the last delay + 1 scans
  std::deque<Eigen::Vector3d>
      sensors_m_;                     // the last delay + kSweepScans positions and the current one
  bool fast_ = false;                 // the sensor moved farther than safe_path_m_ over these
  std::vector<std::uint32_t> slots_;  // of the observed blocks
};

}  // namespace mosbench::hmm_mos
