#pragma once

#include <array>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/tsdf/range_image.hpp"
#include "core/tsdf/sensor_model.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::tsdf {

/// Blocks of 16^3 voxels, in which the authors' map is updated: eight blocks of the voxel room.
inline constexpr int kWideSide = 16;

/// Index of the wide block that a block lies in, and of a wide block's first block.
inline BlockIndex wide_of(const BlockIndex& block) {
  return {block.x >> 1, block.y >> 1, block.z >> 1};
}
inline BlockIndex first_in(const BlockIndex& wide) { return {wide.x * 2, wide.y * 2, wide.z * 2}; }

/// Reusable memory: a byte per wide block around the sensor, per thread.
struct RayBlocksScratch {
  std::vector<std::vector<std::uint8_t>> windows;

  std::size_t memory_bytes() const;
};

/// Rays from the sensor, all lengths in metres.
struct RayLimits {
  double wide_block_m;            ///< edge of a wide block
  Eigen::Vector3d grid_origin_m;  ///< in the map frame
  double min_range_m, max_range_m;
  double beyond_m;  ///< rays end so far behind their points
};

/// Returns the wide blocks on the rays to the points that have a pixel and a range within limits,
/// in the order z, y, x. Walks from the end of the ray to the sensor (Amanatides and Woo, A Fast
/// Voxel Traversal Algorithm, 1987), with as many steps as the two blocks' indices differ.
std::vector<BlockIndex> ray_blocks(std::span<const Point> points, const ScanPixels& pixels,
                                   const Pose& map_from_sensor, const RayLimits& limits,
                                   RayBlocksScratch& scratch, ThreadPool& pool);

/// The map's record of the voxels of a block, 8 bytes each.
struct VoxelNumbers {
  alignas(32) std::array<float, kBlockVoxels> distances_m;  ///< d, to the nearest surface, signed
  alignas(32) std::array<float, kBlockVoxels> weights;      ///< w, 0: never observed
};

/// A block of voxels. Until one of its voxels is observed, it has no numbers: d = w = 0.
struct MapBlock {
  BlockMask observed;      ///< w > 1e-6
  BlockMask near_surface;  ///< d below TsdfMap::near_below_m
  std::uint32_t numbers = kNoSlot;
};

/// The truncated signed distances around the sensor. Wide blocks of 16^3 voxels come and go as a
/// whole.
struct TsdfMap {
  explicit TsdfMap(float near_surface_below_m) : near_below_m(near_surface_below_m) {}

  float near_below_m;
  BlockMap<MapBlock> blocks;
  SlotPool<VoxelNumbers> numbers;

  /// Slots of blocks, eight per wide block, and those of them that were made just now.
  struct Touched {
    std::vector<std::uint32_t> slots, fresh;
  };
  /// Returns all blocks of these wide blocks, in their order, x fastest within each; makes those
  /// that are missing.
  Touched touch(const std::vector<BlockIndex>& wide_blocks);
  /// Gives a block numbers.
  void add_numbers(MapBlock& block);
  /// Removes wide blocks farther from the sensor than map_radius_ranges allows, and returns the
  /// slots of their blocks. Looks at the whole map, so only where the sensor has left the wide
  /// block in which it last did.
  std::vector<std::uint32_t> keep_near(const Eigen::Vector3d& sensor_m, const VoxelGrid& grid,
                                       const Config& config);

  const MapBlock* find(const BlockIndex& index) const {
    const std::uint32_t slot = blocks.find(index);
    return slot == kNoSlot ? nullptr : &blocks[slot];
  }
  /// Returns d of a block's voxel, 0 where it was never observed.
  float distance_m(const MapBlock* block, std::uint32_t cell) const {
    if (block == nullptr || block->numbers == kNoSlot) return 0;
    return numbers[block->numbers].distances_m[cell];
  }
  std::size_t memory_bytes() const { return blocks.memory_bytes() + numbers.memory_bytes(); }

 private:
  std::optional<Eigen::Vector3d> kept_around_m_;
};

}  // namespace mosbench::tsdf
