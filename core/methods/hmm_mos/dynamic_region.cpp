#include "core/methods/hmm_mos/dynamic_region.hpp"

#include <utility>

#include "core/methods/hmm_mos/convolution.hpp"
#include "core/methods/hmm_mos/otsu.hpp"
#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {

DynamicRegion::DynamicRegion(const VoxelGrid& grid, double max_range_m, int dynamic_window_scans,
                             int min_otsu_score)
    : grid_(grid),
      evict_radius_m_(2 * max_range_m),
      dynamic_window_scans_(static_cast<std::uint32_t>(dynamic_window_scans)),
      min_otsu_score_(min_otsu_score) {}

DynamicRegion::Block* DynamicRegion::find(const BlockIndex& block) {
  const std::uint32_t slot = blocks_.find(block);
  return slot == kNoSlot ? nullptr : &blocks_[slot];
}

std::vector<BlockIndex> DynamicRegion::blocks_with(const VoxelSet& dynamic) const {
  std::vector<BlockIndex> blocks;
  blocks_.for_each_slot([&](std::uint32_t slot) { blocks.push_back(blocks_.index_of(slot)); });
  blocks.insert(blocks.end(), dynamic.blocks.begin(), dynamic.blocks.end());
  return blocks;
}

VoxelSet DynamicRegion::back_end(const VoxelizedScan& scan, const VoxelSet& beside_unknown,
                                 int kernel_width_voxels, ThreadPool& pool) const {
  const int radius = radius_of(kernel_width_voxels);
  VoxelSet confident;
  blocks_.for_each_slot([&](std::uint32_t slot) {
    const BlockMask& voxels = blocks_[slot].high_confidence;
    if (voxels.any()) confident.masks[confident.insert(blocks_.index_of(slot))] = voxels;
  });
  const std::vector<std::uint32_t> slots = slots_within(scan, confident, radius);
  std::vector<std::vector<ValueCount>> votes(slots.size());  // per candidate, in cell order
  std::vector<BlockMask> voted(slots.size());
  for_each_block_near(confident, radius, scan, slots, pool,
                      [&](std::size_t i, const HaloRows& rows, const BlockMask& reach) {
                        const BlockMask* beside =
                            beside_unknown.mask_of(scan.measured.blocks[slots[i]]);
                        voted[i] = beside == nullptr ? reach : without(reach, *beside);
                        for_each_cell(voted[i], [&](std::uint32_t cell) {
                          votes[i].push_back({count_around(rows, cell), 1});
                        });
                      });
  std::vector<ValueCount> all;
  for (const auto& some : votes) all.insert(all.end(), some.begin(), some.end());
  const std::optional<double> threshold = otsu_threshold(all);
  if (!threshold) return {};
  std::vector<BlockMask> above(slots.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    auto vote = votes[i].begin();
    for_each_cell(voted[i], [&](std::uint32_t cell) {
      if ((vote++)->value > *threshold) above[i].set(cell);
    });
  }
  return set_of(scan, slots, above);
}

void DynamicRegion::update(const DetectedScan& detected, std::uint32_t scan_index) {
  visit(detected, scan_index);
  std::vector<ValueCount> counts;
  for (std::size_t n = 1; n < count_by_neighbours_.size(); ++n) {
    counts.push_back({static_cast<std::int32_t>(n), count_by_neighbours_[n]});
  }
  threshold_ = otsu_threshold(counts).value_or(threshold_);
  blocks_.for_each_slot([&](std::uint32_t slot) {
    Block& block = blocks_[slot];
    block.high_confidence = {};
    for_each_cell(without(block.dynamic, block.beside_unknown), [&](std::uint32_t cell) {
      if (block.neighbours[cell] > threshold_) block.high_confidence.set(cell);
    });
  });
  evict(detected.scan.sensor_m, scan_index);
}

/// Adds the scan's dynamic voxels. A voxel that a first detection at this time has visited is not
/// changed by a second one.
void DynamicRegion::visit(const DetectedScan& detected, std::uint32_t scan_index) {
  const VoxelSet stamped =
      visited_at_ == scan_index ? std::exchange(visited_, VoxelSet{}) : VoxelSet{};
  const bool may_join = shows_motion(detected.threshold, min_otsu_score_);
  visited_.clear();
  visited_at_ = scan_index;
  if (may_join) {
    for (std::size_t i = 0; i < detected.scan.measured.block_count(); ++i) {
      const BlockIndex& index = detected.scan.measured.blocks[i];
      const Block* block = find(index);
      BlockMask fresh = detected.scan.occupied[i];
      if (block != nullptr) fresh = without(fresh, block->dynamic);
      if (fresh.any()) visited_.masks[visited_.insert(index)] = fresh;
    }
    for (std::size_t i = 0; i < detected.dynamic.block_count(); ++i) {
      const BlockIndex& index = detected.dynamic.blocks[i];
      BlockMask joining = detected.dynamic.masks[i];
      for (const VoxelSet* excluded : {&detected.from_region, &stamped}) {
        const BlockMask* mask = excluded->mask_of(index);
        if (mask != nullptr) joining = without(joining, *mask);
      }
      if (const Block* block = find(index)) joining = without(joining, block->dynamic);
      for_each_cell(joining, [&](std::uint32_t cell) { add(voxel_at(index, cell), scan_index); });
    }
  }
  blocks_.for_each_slot([&](std::uint32_t slot) {
    Block& block = blocks_[slot];
    const BlockIndex& index = blocks_.index_of(slot);
    const BlockMask* occupied = detected.scan.occupied_in(index);
    if (occupied == nullptr) return;
    BlockMask seen = *occupied & block.dynamic;
    if (const BlockMask* mask = stamped.mask_of(index)) seen = without(seen, *mask);
    const BlockMask* beside = detected.beside_unknown.mask_of(index);
    block.beside_unknown = without(block.beside_unknown, seen);
    if (beside != nullptr) block.beside_unknown = block.beside_unknown | (*beside & seen);
  });
}

template <typename Visit>
void DynamicRegion::for_each_dynamic_neighbour(const Voxel& voxel, Visit&& visit) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Voxel neighbour{voxel.x + dx, voxel.y + dy, voxel.z + dz};
        Block* block = find(block_of(neighbour));
        const std::uint32_t cell = cell_of(neighbour);
        if (block != nullptr && block->dynamic.test(cell)) visit(*block, cell);
      }
    }
  }
}

void DynamicRegion::add(const Voxel& voxel, std::uint32_t scan_index) {
  const auto [slot, added] = blocks_.find_or_add(block_of(voxel));
  Block& block = blocks_[slot];
  if (added) block.dynamic = block.beside_unknown = block.high_confidence = {};
  const std::uint32_t cell = cell_of(voxel);
  block.became[cell] = static_cast<std::uint16_t>(scan_index);
  std::uint8_t neighbours = 1;
  for_each_dynamic_neighbour(voxel, [&](Block& other, std::uint32_t other_cell) {
    ++neighbours;
    --count_by_neighbours_[other.neighbours[other_cell]];
    ++count_by_neighbours_[++other.neighbours[other_cell]];
  });
  block.dynamic.set(cell);
  block.neighbours[cell] = neighbours;
  ++count_by_neighbours_[neighbours];
}

void DynamicRegion::remove(std::uint32_t slot, std::uint32_t cell) {
  Block& block = blocks_[slot];
  --count_by_neighbours_[block.neighbours[cell]];
  BlockMask voxel;
  voxel.set(cell);
  block.dynamic = without(block.dynamic, voxel);
  block.beside_unknown = without(block.beside_unknown, voxel);
  block.high_confidence = without(block.high_confidence, voxel);
  for_each_dynamic_neighbour(voxel_at(blocks_.index_of(slot), cell),
                             [&](Block& other, std::uint32_t other_cell) {
                               --count_by_neighbours_[other.neighbours[other_cell]];
                               ++count_by_neighbours_[--other.neighbours[other_cell]];
                             });
}

void DynamicRegion::evict(const Eigen::Vector3d& sensor_m, std::uint32_t scan_index) {
  blocks_.for_each_slot([&](std::uint32_t slot) {
    const Block& block = blocks_[slot];
    BlockMask leaving = without(
        block.dynamic,
        within_range(grid_, blocks_.index_of(slot), block.dynamic, sensor_m, evict_radius_m_));
    for_each_cell(block.dynamic, [&](std::uint32_t cell) {
      const auto age = static_cast<std::uint16_t>(scan_index - block.became[cell]);
      if (age > dynamic_window_scans_) leaving.set(cell);
    });
    for_each_cell(leaving, [&](std::uint32_t cell) { remove(slot, cell); });
    if (!block.dynamic.any()) blocks_.erase(slot);
  });
}

}  // namespace mosbench::hmm_mos
