#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos/change_detection.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/global_window.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/distance_field.hpp"

namespace mosbench::hmm_mos {

/// Starts bringing memory that is about to be written into the cache.
inline void fetch(const void* memory, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const auto* first = static_cast<const char*>(memory);
  for (std::size_t at = 0; at < bytes; at += kLine) __builtin_prefetch(first + at, 1);
}

/// Is told what becomes of the blocks of a map, one call per block, which it knows by its slot.
/// Calls between `begin` and the next one are from several threads, but never two of one slot at a
/// time; `added` is from one thread.
class BlockObserver {
 public:
  virtual ~BlockObserver() = default;
  /// This scan is about to update blocks.
  virtual void begin(std::uint32_t scan_index) = 0;
  /// A new block has this slot, which is below `slot_count`.
  virtual void added(std::uint32_t slot, std::size_t slot_count) = 0;
  /// The block is about to be updated: starts bringing its memory into the cache.
  virtual void fetch(std::uint32_t slot) const = 0;
  /// The states of the voxels that the scan observed, before and after their filter step.
  virtual void updated(std::uint32_t slot, const BlockMask& observed, const BlockStates& before,
                       const BlockStates& after) = 0;
  /// These voxels of the block are as if they had never been seen.
  virtual void forgotten(std::uint32_t slot, const BlockMask& voxels) = 0;
};

/// The map M of the paper (III): beliefs x, states S and ages of the voxels observed in the last
/// w_g scans within the eviction radius.
class VoxelMap {
 public:
  /// The observer, if there is one, outlives the map.
  VoxelMap(const Config& config, const VoxelGrid& grid, BlockObserver* observer = nullptr);

  /// To be called before an `update` with rays that start so far from the scan's position.
  void expect_rays_from(double distance_m) { eviction_.expect_rays_from(distance_m); }

  /// One step x_k = eta B A x_{k-1} of the observed voxels, and their states (paper, III).
  /// `sources` are the measured sets whose union the distance field refers to; `sensor_m` is this
  /// scan's position. Returns the voxels whose state changed.
  VoxelList update(const VoxelList& observed, std::span<const VoxelSet* const> sources,
                   const Eigen::Vector3d& sensor_m, std::uint32_t scan_index, ThreadPool& pool);

  /// To be called after `update`: removes voxels out of range (see Eviction) and those not observed
  /// for more than w_g scans (paper, III).
  void evict(std::uint32_t scan_index);

  /// Returns the known voxels at `scan_index`, those with a state that were observed less than w_g
  /// scans ago, of these blocks and all their neighbours. Not const, because ages are kept lazily
  /// and updated here.
  VoxelSet known_at(std::uint32_t scan_index, std::span<const BlockIndex> blocks, ThreadPool& pool);

  /// Returns P'_chg since `first_scan`: voxels whose last change is at that scan or later.
  VoxelSet changed_since(std::uint32_t first_scan) const { return changes_.since(first_scan); }

  /// The states S of a block's known voxels, those that the scan observed, and the slot by which
  /// its observer knows it.
  struct KnownBlock {
    BlockStates known;
    BlockMask observed;
    std::uint32_t slot;
  };
  /// Returns that of a block at `scan_index`, nullopt where there is none. Not const as `known_at`
  /// is not.
  std::optional<KnownBlock> block_at(std::uint32_t scan_index, const BlockIndex& index);

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
  BlockObserver* observer_;
  std::vector<std::uint32_t> slots_;  // of the observed blocks
};

}  // namespace mosbench::hmm_mos
