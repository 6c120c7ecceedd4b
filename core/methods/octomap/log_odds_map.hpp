#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/methods/octomap/config.hpp"
#include "core/methods/octomap/scan_rays.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::octomap {

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
