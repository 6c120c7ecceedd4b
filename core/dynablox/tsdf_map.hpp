#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/slot_pool.hpp"
#include "core/dynablox/config.hpp"
#include "core/voxel/block_map.hpp"

namespace mosbench::dynablox {

/// What the map knows of the voxels of a block, 14 bytes each.
struct VoxelNumbers {
  alignas(32) std::array<float, kBlockVoxels> distances_m;  ///< d, to the nearest surface, signed
  alignas(32) std::array<float, kBlockVoxels> weights;      ///< w, 0: never observed
  alignas(32) std::array<std::int32_t, kBlockVoxels> last_occupied;  ///< O, frame
  alignas(32) std::array<std::uint16_t, kBlockVoxels> runs;  ///< c, occupied frames in a row
};

/// A block of voxels. Until one of its voxels is observed, all have the same history, and no
/// numbers of their own: d = w = 0.
struct MapBlock {
  BlockMask ever_free;     ///< e
  BlockMask observed;      ///< w > 1e-6
  BlockMask near_surface;  ///< d below the occupied distance
  BlockMask recent;        ///< occupied in the burn-in before frame `recent_frame`
  BlockMask worn;          ///< c at the limit
  std::int32_t recent_frame = 0;
  std::int32_t last_occupied = 0;  ///< of all voxels while there are no numbers
  std::uint16_t run = 0;           ///< of all voxels while there are no numbers
  std::uint32_t numbers = kNoSlot;
};

/// The truncated signed distances around the sensor, with the ever-free voxels. Wide blocks of 16^3
/// voxels come and go as a whole.
struct TsdfMap {
  BlockMap<MapBlock> blocks;
  SlotPool<VoxelNumbers> numbers;
  std::vector<std::uint32_t>
      touched;  ///< slots that the last frame integrated, eight per wide block

  /// Returns the slots of all blocks of these wide blocks, in their order, x fastest within each;
  /// makes those that are missing, last occupied in frame `last_occupied`.
  std::vector<std::uint32_t> touch(const std::vector<BlockIndex>& wide_blocks,
                                   std::int32_t last_occupied);
  /// Gives a block numbers of its own.
  void add_numbers(MapBlock& block, int counter_to_reset);
  /// Removes wide blocks whose centre is farther from the sensor.
  void keep_within(double radius_m, const VoxelGrid& grid, const Eigen::Vector3d& sensor_m);

  const MapBlock* find(const BlockIndex& index) const {
    const std::uint32_t slot = blocks.find(index);
    return slot == kNoSlot ? nullptr : &blocks[slot];
  }
  /// Returns the voxels of a block that are ever-free; none where there is no block.
  BlockMask ever_free_in(const BlockIndex& index) const {
    const MapBlock* block = find(index);
    return block == nullptr ? BlockMask{} : block->ever_free;
  }
  std::size_t memory_bytes() const;
};

}  // namespace mosbench::dynablox
