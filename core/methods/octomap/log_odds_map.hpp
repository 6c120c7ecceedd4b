#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/methods/octomap/config.hpp"
#include "core/voxel/exact_rays.hpp"
#include "core/voxel/voxel.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::octomap {

/// The changes that one scan makes to the map.
struct ScanUpdate {
  VoxelSet hit;                               ///< end voxels of points within the range limit
  VoxelList free;                             ///< voxels on the rays, some of them hit
  std::vector<std::uint32_t> voxel_of_point;  ///< slot in `hit` * 512 + cell, or kNoVoxel
};

/// Finds what OctoMap's computeUpdate finds, rounded as there: points in single precision, counted
/// from the grid's origin. Points at or within min_range, and those that are not finite, are left
/// out.
ScanUpdate update_of(const PosedScan& scan, const VoxelGrid& grid, const Config& config,
                     std::vector<RayWindow>& windows, ThreadPool& pool);

/// A voxel that the map keeps.
struct Leaf {
  Voxel voxel;
  float log_odds;
};

/// OctoMap's octree of log-odds (Hornung et al. 2013), without pruning. Leaves are written block by
/// block through the library's nodes instead of voxel by voxel from the root. Coordinates are
/// taken modulo the 2^16 voxels of the tree.
class LogOddsMap {
 public:
  explicit LogOddsMap(const Config& config);
  ~LogOddsMap();

  /// As insertPointCloud: voxels that are hit get one hit, the others on rays one miss.
  void enter(const ScanUpdate& update);

  /// Returns the log-odds of the voxels that are hit, 512 per block of `update.hit`: not a number
  /// where a voxel was never observed, anything where it is not hit.
  std::vector<float> log_odds_of(const VoxelSet& voxels) const;

  /// Forgets the blocks whose low corner is farther than `radius_voxels` from `centre`.
  void keep_within(const Voxel& centre, double radius_voxels);

  std::vector<Leaf> leaves() const;
  std::size_t block_count() const;
  std::size_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mosbench::octomap
