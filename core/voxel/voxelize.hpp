#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// Number of a voxel inside a VoxelizedScan: slot of its block * 512 + cell.
inline constexpr std::uint32_t kNoVoxel = ~std::uint32_t{0};

/// What one of several sensors measured of a scan; `measured` has all blocks of the scan.
struct OwnVoxels {
  Eigen::Vector3d sensor_m;
  Voxel sensor_voxel;
  VoxelSet measured;
};

/// A scan as sets of voxels. `occupied` runs together with `measured.blocks`.
struct VoxelizedScan {
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();  ///< in the map frame
  Voxel sensor_voxel;
  VoxelSet measured;                          ///< every voxel with a participating point
  std::vector<BlockMask> occupied;            ///< those with a lower corner within max_range
  std::vector<std::uint32_t> voxel_of_point;  ///< kNoVoxel for points that do not take part
  std::size_t occupied_count = 0;
  std::size_t nonfinite_points = 0;
  std::vector<OwnVoxels> by_origin;  ///< empty: all rays start at sensor_m

  /// Calls visit(sensor_m, sensor_voxel, measured) for each place that rays start at.
  template <typename Visit>
  void for_each_origin(Visit&& visit) const {
    if (by_origin.empty()) visit(sensor_m, sensor_voxel, measured);
    for (const OwnVoxels& own : by_origin) visit(own.sensor_m, own.sensor_voxel, own.measured);
  }
  const BlockMask* occupied_in(const BlockIndex& block) const {
    const std::uint32_t slot = measured.find(block);
    return slot == kNoSlot ? nullptr : &occupied[slot];
  }
  /// Returns the voxels of a set that are occupied.
  VoxelSet occupied_among(const VoxelSet& voxels) const;
  std::size_t memory_bytes() const {
    std::size_t own_bytes = 0;
    for (const OwnVoxels& own : by_origin) own_bytes += own.measured.memory_bytes();
    return own_bytes + measured.memory_bytes() + occupied.capacity() * sizeof(BlockMask) +
           voxel_of_point.capacity() * sizeof(std::uint32_t);
  }
};

/// Returns a grid whose origin is near the first sensor position, so that voxel indices stay small.
VoxelGrid grid_around(const Eigen::Vector3d& sensor_m, double voxel_size_m);

/// Finds the measured voxels P'_M = floor(P_M / Delta) of P_M = T_{M->S} P_S (paper, III). Takes
/// the points farther than min_range from their sensor; a negative min_range takes all. Throws
/// std::range_error naming the first point whose voxel lies more than 2^19 voxels from its sensor's
/// or 2^23 from the grid's origin. `origins` were checked.
VoxelizedScan voxelize(std::span<const Point> points, const Pose& map_from_sensor,
                       const VoxelGrid& grid, double min_range_m, double max_range_m,
                       ThreadPool& pool, const RayOrigins& origins = {});

/// Returns the voxel that holds a position of the map frame. Throws std::range_error beyond 2^23
/// voxels from the grid's origin.
Voxel voxel_of(const Eigen::Vector3d& position_m, const VoxelGrid& grid);

/// Returns a label per point (paper, III: points take the label of their voxel): kMovingLabel in
/// voxels of `moving`, masks in the order of scan.measured.blocks, kStaticLabel elsewhere.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan,
                                          std::span<const BlockMask> moving);

/// Returns the score of every point's voxel, 0 where the point has no voxel.
/// `score_of(slot, cell)` is that of a cell of scan.measured.blocks[slot].
template <typename ScoreOf>
std::vector<float> project_scores(const VoxelizedScan& scan, ScoreOf&& score_of) {
  std::vector<float> scores(scan.voxel_of_point.size(), 0);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel != kNoVoxel) scores[i] = score_of(voxel / kBlockVoxels, voxel % kBlockVoxels);
  }
  return scores;
}

}  // namespace mosbench
