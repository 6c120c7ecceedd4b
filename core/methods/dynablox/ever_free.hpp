#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/tsdf/tsdf_map.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::dynablox {

/// When the voxels of a block were occupied, 6 bytes each.
struct VoxelHistory {
  alignas(32) std::array<std::int32_t, kBlockVoxels> last_occupied;  ///< O, frame
  alignas(32) std::array<std::uint16_t, kBlockVoxels> runs;  ///< c, occupied frames in a row
};

/// The memory of a block. Until one of its voxels is observed, all have the same history.
struct BlockHistory {
  BlockMask ever_free;  ///< e
  BlockMask recent;     ///< occupied in the burn-in before frame `recent_frame`
  BlockMask worn;       ///< c at the limit
  std::int32_t recent_frame = 0;
  std::int32_t last_occupied = 0;  ///< of all voxels while `voxels` is kNoSlot
  std::uint16_t run = 0;           ///< of all voxels while `voxels` is kNoSlot
  std::uint32_t voxels = kNoSlot;  ///< the VoxelHistory
};

/// Signed distances around the sensor, with the ever-free voxels.
struct EverFreeMap {
  explicit EverFreeMap(float occupied_below_m) : tsdf(occupied_below_m) {}

  tsdf::TsdfMap tsdf;
  std::vector<BlockHistory> histories;  ///< by slot of the map's blocks
  SlotPool<VoxelHistory> voxels;
  std::vector<std::uint32_t> touched;  ///< slots that the last frame integrated

  /// Touches the blocks of these wide blocks; new ones were last occupied in frame `last_occupied`.
  void touch(const std::vector<BlockIndex>& wide_blocks, std::int32_t last_occupied);
  /// Gives touched blocks that have numbers since this frame voxels with a history each.
  void add_voxels(int counter_to_reset);
  void keep_near(const Eigen::Vector3d& sensor_m, const VoxelGrid& grid,
                 const tsdf::Config& config);

  /// Returns the voxels of a block that are ever-free; none where there is no block.
  BlockMask ever_free_in(const BlockIndex& index) const {
    const std::uint32_t slot = tsdf.blocks.find(index);
    return slot == kNoSlot ? BlockMask{} : histories[slot].ever_free;
  }
  std::size_t memory_bytes() const;
};

/// Brings the ever-free voxels of the blocks touched by the last integration up to frame f, whose
/// points lie in `measured`. First, each voxel that is near a surface or holds a point is occupied:
/// c = c + 1 if O >= f - buffer, else 1; O = f. An ever-free voxel with c at the limit is ever-free
/// no more, nor are its 26 neighbours. Then each observed voxel becomes ever-free when it and its
/// 26 neighbours are observed and were not occupied since frame f - burn-in.
void update_ever_free(EverFreeMap& map, const VoxelSet& measured, std::int32_t frame,
                      const Config& config, ThreadPool& pool);

}  // namespace mosbench::dynablox
