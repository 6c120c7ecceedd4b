#include "core/hmm_mos/voxel_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/hmm_mos/change_detection.hpp"
#include "core/voxel/source_grid.hpp"

namespace mosbench::hmm_mos {
namespace {

/// Starts bringing memory that is about to be written into the cache.
void fetch(const void* memory, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const auto* first = static_cast<const char*>(memory);
  for (std::size_t at = 0; at < bytes; at += kLine) __builtin_prefetch(first + at, 1);
}

/// The same for beliefs in the layers of some cells.
void fetch(const BlockBeliefs& beliefs, const BlockMask& cells) {
  constexpr std::size_t kLayer = kBlockSide * kBlockSide;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    if (cells.words[z] != 0) fetch(&beliefs.occupied[z * kLayer], kLayer * sizeof(float));
  }
}

}  // namespace

VoxelMap::VoxelMap(const Config& config, const VoxelGrid& grid)
    : grid_(grid),
      variant_(config.variant),
      filter_(config.voxel_size_m, config.sigma_m(), config.transition_epsilon,
              config.min_state_probability),
      distance_field_(filter_.radius()),
      global_window_scans_(static_cast<std::uint32_t>(config.global_window_scans)),
      // A block is refreshed at the latest w_g and a sweep after it was seen last, and its voxels
      // were younger than w_g + 2 then.
      age_planes_(LastSeen::planes_for(2 * global_window_scans_ + 4 * kSweepScans)),
      delay_scans_(static_cast<std::uint32_t>(config.delay_scans)),
      evict_radius_m_((config.variant == Variant::kPaper2024 ? 2.0 : 1.5) * config.max_range_m) {
  // What detection asks of the map lies within max_range plus the kernel of a sensor position.
  const double asked_m =
      config.max_range_m + (config.kernel_width_voxels + 2) * config.voxel_size_m * std::sqrt(3.0);
  safe_path_m_ = evict_radius_m_ - asked_m;
}

std::uint32_t VoxelMap::add_block(const BlockIndex& index, std::uint32_t scan_index) {
  const std::uint32_t slot = blocks_.take();
  if (beliefs_of_.size() < blocks_.capacity()) beliefs_of_.resize(blocks_.capacity(), kNoSlot);
  Block& block = blocks_[slot];
  block.index = index;
  block.oldest_seen = block.newest_seen = scan_index;
  block.live = true;
  block.states = {};
  block.seen = block.fresh = block.nonzero = block.stale = block.ageless = {};
  return slot;
}

void VoxelMap::drop_block(std::uint32_t slot) {
  Block& block = blocks_[slot];
  if (beliefs_of_[slot] != kNoSlot) beliefs_.give_back(beliefs_of_[slot]);
  beliefs_of_[slot] = kNoSlot;
  table_.erase(block.index);
  block.live = false;
  blocks_.give_back(slot);
}

/// Removes records as if the voxels had never been seen.
void VoxelMap::forget(Block& block, const BlockMask& voxels) {
  block.seen = without(block.seen, voxels);
  block.fresh = without(block.fresh, voxels);
  block.nonzero = without(block.nonzero, voxels);
  block.stale = without(block.stale, voxels);
  block.ageless = without(block.ageless, voxels);
  block.states.occupied = without(block.states.occupied, voxels);
  block.states.free = without(block.states.free, voxels);
}

/// Records when voxels that may not be seen again were seen last.
void VoxelMap::stamp_fresh(Block& block, const BlockMask& voxels) {
  block.last_seen.stamp(voxels, block.newest_seen, age_planes_);
}

/// A record of age w_g still exists but is not known; one that was evicted after the last scan has
/// age w_g + 2 now.
void VoxelMap::refresh_block(Block& block, std::uint32_t scan_index) {
  const std::uint32_t w_g = global_window_scans_;
  if (scan_index - block.oldest_seen < w_g) return;
  stamp_fresh(block, block.fresh);
  const LastSeen::Ages ages(block.last_seen, scan_index, age_planes_);
  const BlockMask aging = without(block.seen, block.ageless);
  const BlockMask stale = aging & ages.at_least(w_g);
  BlockMask expired = aging & ages.at_least(w_g + 2);
  if (variant_ == Variant::kRelease2025) {
    // Last seen at scan w_g or before.
    block.ageless = block.ageless | (stale & ages.at_least(scan_index - w_g));
    expired = without(expired, block.ageless);
  }
  block.stale = stale | block.ageless;
  forget(block, expired);
  block.oldest_seen = scan_index - ages.greatest(without(block.seen, block.ageless));
}

VoxelSet VoxelMap::known_at(std::uint32_t scan_index, std::span<const BlockIndex> blocks,
                            ThreadPool& pool) {
  std::vector<std::uint32_t> around(blocks.size() * 27);
  pool.for_ranges(blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      for_each_neighbour(blocks[i], [&](std::size_t position, const BlockIndex& block) {
        around[i * 27 + position] = table_.find(block);
      });
    }
  });
  VoxelSet known;
  std::vector<std::uint32_t> asked;
  std::vector<std::uint8_t> taken(blocks_.capacity());
  for (const std::uint32_t slot : around) {
    if (slot == kNoSlot || taken[slot] != 0) continue;
    taken[slot] = 1;
    asked.push_back(slot);
    known.insert(blocks_[slot].index);
  }
  pool.for_ranges(asked.size(), 256, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      Block& block = blocks_[asked[i]];
      refresh_block(block, scan_index);
      known.masks[i] = without(block.states.occupied | block.states.free, block.stale);
    }
  });
  return known;
}

VoxelList VoxelMap::update(const VoxelList& observed, std::span<const VoxelSet* const> sources,
                           const Eigen::Vector3d& sensor_m, std::uint32_t scan_index,
                           ThreadPool& pool) {
  note_sensor(sensor_m, scan_index);
  drop_expired_changes(scan_index);
  const int reach = distance_field_.reach(), side = 2 * reach + 1;
  const SourceGrid grid(sources, observed.blocks, reach);

  // Allocation is serial; then each block is updated on its own.
  std::vector<std::uint8_t> near(observed.blocks.size());
  slots_.resize(observed.blocks.size());
  for (std::size_t i = 0; i < observed.blocks.size(); ++i) {
    const BlockIndex& index = observed.blocks[i];
    std::uint32_t slot = table_.find(index);
    if (slot == kNoSlot) slot = table_.find_or_insert(index, add_block(index, scan_index));
    slots_[i] = slot;
    near[i] = grid.any_around(index, reach);
    if (near[i] != 0 && beliefs_of_[slot] == kNoSlot) beliefs_of_[slot] = beliefs_.take();
  }

  constexpr std::size_t kTouchedBytes = sizeof(Block) - sizeof(LastSeen) + LastSeen::kTouchedBytes;
  std::vector<BlockMask> changed(observed.blocks.size());
  pool.for_ranges(observed.blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    std::vector<const SourceBlock*> around(static_cast<std::size_t>(side * side * side));
    ColumnDistances column(distance_field_);
    BlockDistances distances;
    for (std::size_t i = begin; i < end; ++i) {
      Block& block = blocks_[slots_[i]];
      if (i + 1 < end) fetch(&blocks_[slots_[i + 1]], kTouchedBytes);
      refresh_block(block, scan_index);
      const BlockStates before = block.states;
      if (near[i] != 0) {
        BlockBeliefs& beliefs = beliefs_[beliefs_of_[slots_[i]]];
        fetch(beliefs, observed.masks[i]);
        grid.neighbours(block.index, reach, around);
        column.find(block.index, observed.masks[i], around, distances);
        filter_.update(observed.masks[i], block.seen, distances, block.nonzero, beliefs,
                       block.states);
      } else {
        BeliefFilter::update_far(observed.masks[i], block.nonzero, block.states);
      }
      changed[i] = detect_changes(before, block.states);
      block.seen = block.seen | observed.masks[i];
      block.stale = without(block.stale, observed.masks[i]);
      block.ageless = without(block.ageless, observed.masks[i]);
      stamp_fresh(block, without(block.fresh, observed.masks[i]));
      block.fresh = observed.masks[i];
      block.newest_seen = scan_index;
    }
  });

  VoxelList changes;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (!changed[i].any()) continue;
    changes.blocks.push_back(observed.blocks[i]);
    changes.masks.push_back(changed[i]);
  }
  changes_.push_back({scan_index, changes});
  while (changes_.size() > delay_scans_ + 1) changes_.pop_front();
  return changes;
}

/// Keeps the recent positions and finds out whether amortised eviction still changes nothing.
void VoxelMap::note_sensor(const Eigen::Vector3d& sensor_m, std::uint32_t scan_index) {
  double path_m = 0;
  for (std::size_t i = 1; i < sensors_m_.size(); ++i) {
    path_m += (sensors_m_[i] - sensors_m_[i - 1]).norm();
  }
  if (!sensors_m_.empty()) path_m += (sensor_m - sensors_m_.back()).norm();
  const bool fast = path_m > safe_path_m_;
  // What the positions up to the last scan evict has to go before this scan may see it again.
  if (fast && !fast_ && scan_index > 0) sweep(0, 1, 0, sensors_m_.size(), scan_index - 1);
  fast_ = fast;
  sensors_m_.push_back(sensor_m);
  while (sensors_m_.size() > kSweepScans + delay_scans_ + 1) sensors_m_.pop_front();
}

void VoxelMap::evict(std::uint32_t scan_index) {
  const std::size_t sensors = sensors_m_.size();
  if (fast_) {
    sweep(0, 1, sensors - 1, sensors, scan_index);
  } else {
    sweep(scan_index % kSweepScans, kSweepScans,
          sensors - std::min<std::size_t>(sensors, kSweepScans), sensors, scan_index);
  }
}

void VoxelMap::sweep(std::uint32_t first_slot, std::uint32_t stride, std::size_t first_sensor,
                     std::size_t last_sensor, std::uint32_t scan_index) {
  for (std::uint32_t slot = first_slot; slot < blocks_.capacity(); slot += stride) {
    if (blocks_[slot].live) evict_from_block(slot, first_sensor, last_sensor, scan_index);
  }
}

void VoxelMap::evict_from_block(std::uint32_t slot, std::size_t first_sensor,
                                std::size_t last_sensor, std::uint32_t scan_index) {
  Block& block = blocks_[slot];
  BlockMask kept = block.seen;
  for (std::size_t i = first_sensor; i < last_sensor; ++i) {
    kept = within_range(grid_, block.index, kept, sensors_m_[i], evict_radius_m_);
  }
  if (!(kept == block.seen)) {
    const BlockMask evicted = without(block.seen, kept);
    forget(block, evicted);
    for (ChangesOfScan& changes : changes_) {
      for (std::size_t i = 0; i < changes.voxels.blocks.size(); ++i) {
        if (changes.voxels.blocks[i] == block.index) {
          changes.voxels.masks[i] = without(changes.voxels.masks[i], evicted);
        }
      }
    }
  }
  if (scan_index - block.newest_seen >= global_window_scans_) refresh_block(block, scan_index);
  if (!block.seen.any()) drop_block(slot);
}

/// An expired record loses its last change; a new record starts as "never changed".
void VoxelMap::drop_expired_changes(std::uint32_t scan_index) {
  for (ChangesOfScan& changes : changes_) {
    if (scan_index - changes.scan_index < global_window_scans_ + 2) return;
    for (std::size_t i = 0; i < changes.voxels.blocks.size(); ++i) {
      const std::uint32_t slot = table_.find(changes.voxels.blocks[i]);
      if (slot != kNoSlot) refresh_block(blocks_[slot], scan_index);
      BlockMask& mask = changes.voxels.masks[i];
      mask = slot == kNoSlot ? BlockMask{} : mask & blocks_[slot].seen;
    }
  }
}

VoxelSet VoxelMap::changed_since(std::uint32_t first_scan) const {
  VoxelSet changed;
  for (const ChangesOfScan& changes : changes_) {
    if (changes.scan_index < first_scan) continue;
    for (std::size_t i = 0; i < changes.voxels.blocks.size(); ++i) {
      const std::uint32_t slot = changed.insert(changes.voxels.blocks[i]);
      changed.masks[slot] = changed.masks[slot] | changes.voxels.masks[i];
    }
  }
  return changed;
}

std::size_t VoxelMap::memory_bytes() const {
  return table_.memory_bytes() + blocks_.memory_bytes() + beliefs_.memory_bytes() +
         beliefs_of_.capacity() * sizeof(std::uint32_t);
}

}  // namespace mosbench::hmm_mos
