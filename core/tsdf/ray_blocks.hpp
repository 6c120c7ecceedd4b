#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/tsdf/range_image.hpp"
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

}  // namespace mosbench::tsdf
