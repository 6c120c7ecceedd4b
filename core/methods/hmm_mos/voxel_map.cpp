#include "core/methods/hmm_mos/voxel_map.hpp"

namespace mosbench::hmm_mos {
namespace {

/// Fetches beliefs in the layers of some cells.
void fetch_layers(const BeliefNumbers& numbers, const BlockMask& cells) {
  constexpr std::size_t kLayer = kBlockSide * kBlockSide;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    if (cells.words[z] != 0) fetch(&numbers.occupied[z * kLayer], kLayer * sizeof(float));
  }
}

}  // namespace

VoxelMap::VoxelMap(const Config& config, const VoxelGrid& grid, BlockObserver* observer)
    : variant_(config.variant),
      filter_(config.voxel_size_m, config.sigma_m(), config.transition_epsilon,
              config.min_state_probability),
      distance_field_(filter_.radius()),
      eviction_(config, grid),
      changes_(static_cast<std::size_t>(config.delay_scans) + 1),
      global_window_scans_(static_cast<std::uint32_t>(config.global_window_scans)),
      evicted_after_(global_window_scans_ + 2),
      // A block is refreshed at the latest w_g and a sweep after it was seen last, and its voxels
      // were younger than evicted_after_ then.
      age_planes_(LastSeen::planes_for(2 * global_window_scans_ + 4 * Eviction::kSweepScans)),
      observer_(observer) {}

std::uint32_t VoxelMap::find_or_add(const BlockIndex& index, std::uint32_t scan_index) {
  const auto [slot, added] = blocks_.find_or_add(index);
  if (!added) return slot;
  if (numbers_of_.size() < blocks_.slot_count()) numbers_of_.resize(blocks_.slot_count(), kNoSlot);
  if (observer_ != nullptr) observer_->added(slot, blocks_.slot_count());
  Block& block = blocks_[slot];
  block.oldest_seen = block.newest_seen = scan_index;
  block.states = {};
  block.beliefs = {};
  block.fresh = block.stale = block.ageless = {};
  return slot;
}

void VoxelMap::drop_block(std::uint32_t slot) {
  if (numbers_of_[slot] != kNoSlot) numbers_.give_back(numbers_of_[slot]);
  numbers_of_[slot] = kNoSlot;
  blocks_.erase(slot);
}

/// Removes records as if the voxels had never been seen.
void VoxelMap::forget(std::uint32_t slot, const BlockMask& voxels) {
  if (observer_ != nullptr) observer_->forgotten(slot, voxels);
  Block& block = blocks_[slot];
  block.beliefs.forget(voxels);
  block.fresh = without(block.fresh, voxels);
  block.stale = without(block.stale, voxels);
  block.ageless = without(block.ageless, voxels);
  block.states.occupied = without(block.states.occupied, voxels);
  block.states.free = without(block.states.free, voxels);
}

/// Records when voxels that may not be seen again were seen last.
void VoxelMap::stamp_fresh(Block& block, const BlockMask& voxels) {
  block.last_seen.stamp(voxels, block.newest_seen, age_planes_);
}

void VoxelMap::mark_seen(Block& block, const BlockMask& voxels, std::uint32_t scan_index) {
  block.stale = without(block.stale, voxels);
  block.ageless = without(block.ageless, voxels);
  stamp_fresh(block, without(block.fresh, voxels));
  block.fresh = voxels;
  block.newest_seen = scan_index;
}

/// Updates the ages. A record of age w_g still exists but is not known.
void VoxelMap::refresh_block(std::uint32_t slot, std::uint32_t scan_index) {
  Block& block = blocks_[slot];
  const std::uint32_t w_g = global_window_scans_;
  if (scan_index - block.oldest_seen < w_g) return;
  stamp_fresh(block, block.fresh);
  const LastSeen::Ages ages(block.last_seen, scan_index, age_planes_);
  const BlockMask aging = without(block.beliefs.seen(), block.ageless);
  const BlockMask stale = aging & ages.at_least(w_g);
  BlockMask expired = aging & ages.at_least(evicted_after_);
  if (variant_ == Variant::kRelease2025) {
    // Last seen at scan w_g or before.
    block.ageless = block.ageless | (stale & ages.at_least(scan_index - w_g));
    expired = without(expired, block.ageless);
  }
  block.stale = stale | block.ageless;
  forget(slot, expired);
  block.oldest_seen = scan_index - ages.greatest(without(block.beliefs.seen(), block.ageless));
}

VoxelSet VoxelMap::known_at(std::uint32_t scan_index, std::span<const BlockIndex> blocks,
                            ThreadPool& pool) {
  std::vector<std::uint32_t> around(blocks.size() * 27);
  pool.for_ranges(blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      for_each_neighbour(blocks[i], [&](std::size_t position, const BlockIndex& block) {
        around[i * 27 + position] = blocks_.find(block);
      });
    }
  });
  std::vector<std::uint32_t> asked;
  std::vector<std::uint8_t> taken(blocks_.slot_count());
  for (const std::uint32_t slot : around) {
    if (slot == kNoSlot || taken[slot] != 0) continue;
    taken[slot] = 1;
    asked.push_back(slot);
  }
  VoxelSet known;
  known.reserve(asked.size());
  for (const std::uint32_t slot : asked) known.insert(blocks_.index_of(slot));
  pool.for_ranges(asked.size(), 256, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Block& block = blocks_[asked[i]];
      refresh_block(asked[i], scan_index);
      known.masks[i] = without(block.states.occupied | block.states.free, block.stale);
    }
  });
  return known;
}

/// An expired record loses its last change; a new record starts as "never changed".
void VoxelMap::forget_changes_of_expired(std::uint32_t scan_index) {
  if (scan_index < evicted_after_) return;
  changes_.keep_until(scan_index - evicted_after_, [&](const BlockIndex& index) {
    const std::uint32_t slot = blocks_.find(index);
    if (slot == kNoSlot) return BlockMask{};
    refresh_block(slot, scan_index);
    return blocks_[slot].beliefs.seen();
  });
}

/// Finds or adds the blocks, and numbers for those with sources near. Returns which these are.
std::vector<std::uint8_t> VoxelMap::allocate(std::span<const BlockIndex> blocks,
                                             const SourceGrid& grid, std::uint32_t scan_index) {
  std::vector<std::uint8_t> near(blocks.size());
  slots_.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    slots_[i] = find_or_add(blocks[i], scan_index);
    near[i] = grid.any_around(blocks[i], distance_field_.reach());
    std::uint32_t& numbers = numbers_of_[slots_[i]];
    if (near[i] != 0 && numbers == kNoSlot) numbers = numbers_.take();
  }
  return near;
}

std::optional<VoxelMap::KnownBlock> VoxelMap::block_at(std::uint32_t scan_index,
                                                       const BlockIndex& index) {
  const std::uint32_t slot = blocks_.find(index);
  if (slot == kNoSlot) return std::nullopt;
  refresh_block(slot, scan_index);
  const Block& block = blocks_[slot];
  const bool is_observed = block.newest_seen == scan_index;
  return KnownBlock{
      {without(block.states.occupied, block.stale), without(block.states.free, block.stale)},
      is_observed ? block.fresh : BlockMask{},
      slot};
}

VoxelList VoxelMap::update(const VoxelList& observed, std::span<const VoxelSet* const> sources,
                           const Eigen::Vector3d& sensor_m, std::uint32_t scan_index,
                           ThreadPool& pool) {
  if (observer_ != nullptr) observer_->begin(scan_index);
  if (const auto due = eviction_.enter(sensor_m)) run(*due, scan_index - 1);
  forget_changes_of_expired(scan_index);
  const int reach = distance_field_.reach(), side = 2 * reach + 1;
  const SourceGrid grid(sources, observed.blocks, reach);

  // Allocation is serial; then each block is updated on its own.
  const std::vector<std::uint8_t> near = allocate(observed.blocks, grid, scan_index);
  constexpr std::size_t kTouchedBytes = sizeof(Block) - sizeof(LastSeen) + LastSeen::kTouchedBytes;
  std::vector<BlockMask> changed(observed.blocks.size());
  pool.for_ranges(observed.blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    std::vector<const SourceBlock*> around(static_cast<std::size_t>(side * side * side));
    ColumnDistances column(distance_field_);
    BlockDistances distances;
    for (std::size_t i = begin; i < end; ++i) {
      const BlockIndex& index = observed.blocks[i];
      const BlockMask& voxels = observed.masks[i];
      Block& block = blocks_[slots_[i]];
      if (i + 1 < end) fetch(&blocks_[slots_[i + 1]], kTouchedBytes);
      if (i + 1 < end && observer_ != nullptr) observer_->fetch(slots_[i + 1]);
      refresh_block(slots_[i], scan_index);
      const BlockStates before = block.states;
      if (near[i] != 0) {
        BeliefNumbers& numbers = numbers_[numbers_of_[slots_[i]]];
        fetch_layers(numbers, voxels);
        grid.neighbours(index, reach, around);
        column.find(index, voxels, around, distances);
        filter_.update(voxels, distances, block.beliefs, numbers, block.states);
      } else {
        BeliefFilter::update_far(voxels, block.beliefs, block.states);
      }
      changed[i] = detect_changes(before, block.states);
      if (observer_ != nullptr) observer_->updated(slots_[i], voxels, before, block.states);
      mark_seen(block, voxels, scan_index);
    }
  });

  VoxelList changes;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (!changed[i].any()) continue;
    changes.blocks.push_back(observed.blocks[i]);
    changes.masks.push_back(changed[i]);
  }
  changes_.add(scan_index, changes);
  return changes;
}

void VoxelMap::evict(std::uint32_t scan_index) {
  run(eviction_.sweep_after(scan_index), scan_index);
}

void VoxelMap::run(const Sweep& sweep, std::uint32_t scan_index) {
  const auto visit = [&](std::uint32_t slot) {
    Block& block = blocks_[slot];
    const BlockIndex& index = blocks_.index_of(slot);
    const BlockMask kept = eviction_.within(sweep, index, block.beliefs.seen());
    if (!(kept == block.beliefs.seen())) {
      const BlockMask evicted = without(block.beliefs.seen(), kept);
      forget(slot, evicted);
      changes_.forget(index, evicted);
    }
    if (scan_index - block.newest_seen >= global_window_scans_) refresh_block(slot, scan_index);
    if (!block.beliefs.seen().any()) drop_block(slot);
  };
  blocks_.for_each_slot(visit, sweep.first_slot, sweep.stride);
}

std::size_t VoxelMap::memory_bytes() const {
  return blocks_.memory_bytes() + numbers_.memory_bytes() +
         numbers_of_.capacity() * sizeof(std::uint32_t);
}

}  // namespace mosbench::hmm_mos
