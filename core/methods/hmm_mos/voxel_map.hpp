#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/base/slot_pool.hpp"
#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos/block_history.hpp"
#include "core/methods/hmm_mos/change_log.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/eviction.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/methods/hmm_mos/last_seen.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/source_grid.hpp"

namespace mosbench::hmm_mos {

/// The map M of the paper (III): beliefs x, states S and ages of the voxels observed in the last
/// w_g scans within the eviction radius.
class VoxelMap {
 public:
  /// The paper's method needs no history.
  enum class Keeps { kStates, kStatesAndHistory };

  VoxelMap(const Config& config, const VoxelGrid& grid, Keeps keeps = Keeps::kStates);

  /// One step x_k = eta B A x_{k-1} of the observed voxels, and their states (paper, III).
  /// `sources` are the measured sets whose union the distance field refers to; `sensor_m` is this
  /// scan's position; histories count by `tick`, without one by scans. Returns the voxels whose
  /// state changed.
  VoxelList update(const VoxelList& observed, std::span<const VoxelSet* const> sources,
                   const Eigen::Vector3d& sensor_m, std::uint32_t scan_index, ThreadPool& pool,
                   const std::optional<Tick>& tick = std::nullopt);

  /// To be called after `update`: removes voxels out of range (see Eviction) and those not observed
  /// for more than w_g scans (paper, III).
  void evict(std::uint32_t scan_index);

  /// Returns the known voxels at `scan_index`, those with a state that were observed less than w_g
  /// scans ago, of these blocks and all their neighbours. Not const, because ages are kept lazily
  /// and updated here.
  VoxelSet known_at(std::uint32_t scan_index, std::span<const BlockIndex> blocks, ThreadPool& pool);

  /// Returns P'_chg since `first_scan`: voxels whose last change is at that scan or later.
  VoxelSet changed_since(std::uint32_t first_scan) const { return changes_.since(first_scan); }

  /// The states S of a block's known voxels, and how all its voxels came to theirs.
  struct Past {
    BlockStates known;
    const BlockHistory& history;
    std::uint32_t tick;  ///< of the last update
  };
  /// Returns that of a block at `scan_index`, nullopt where there is none; for maps that keep it.
  /// Not const as `known_at` is not.
  std::optional<Past> past_at(std::uint32_t scan_index, const BlockIndex& index);

  std::size_t block_count() const { return blocks_.size(); }
  std::size_t memory_bytes() const;

 private:
  struct Block {
    std::uint32_t oldest_seen;  // lower bound of last_seen over voxels that age
    std::uint32_t newest_seen;
    BlockStates states;
    BlockBeliefs beliefs;
    BlockMask fresh;     // seen at newest_seen, not yet in last_seen
    BlockMask stale;     // not seen for w_g scans or more
    BlockMask ageless;   // release-2025: stale and never to expire
    LastSeen last_seen;  // last: most of it is seldom touched
  };

  std::uint32_t find_or_add(const BlockIndex& index, std::uint32_t scan_index);
  void refresh_block(std::uint32_t slot, std::uint32_t scan_index);
  void stamp_fresh(Block& block, const BlockMask& voxels);
  void mark_seen(Block& block, const BlockMask& voxels, std::uint32_t scan_index);
  void forget_changes_of_expired(std::uint32_t scan_index);
  std::vector<std::uint8_t> allocate(std::span<const BlockIndex> blocks, const SourceGrid& grid,
                                     std::uint32_t scan_index);
  void forget(std::uint32_t slot, const BlockMask& voxels);
  void run(const Sweep& sweep, std::uint32_t scan_index);
  void drop_block(std::uint32_t slot);

  Variant variant_;
  BeliefFilter filter_;
  DistanceField distance_field_;
  Eviction eviction_;
  ChangeLog changes_;
  std::uint32_t global_window_scans_;
  std::uint32_t evicted_after_;  // age at which an update no longer finds the record: it left after
                                 // the scan before, at age w_g + 1
  int age_planes_;
  BlockMap<Block> blocks_;
  SlotPool<BeliefNumbers> numbers_;
  // Slot in numbers_ by slot of the block, or kNoSlot while no voxel has a number. Not in the
  // block, which the serial part of `update` would fetch from memory to ask.
  std::vector<std::uint32_t> numbers_of_;
  bool keeps_history_;
  Tick tick_;                           // of the last update
  std::deque<BlockHistory> histories_;  // by slot of the block, or none at all
  std::vector<std::uint32_t> slots_;    // of the observed blocks
};

}  // namespace mosbench::hmm_mos
