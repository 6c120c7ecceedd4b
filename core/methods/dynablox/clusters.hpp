#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/dynablox/config.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dynablox {

/// A box of whole voxels; corners are voxels inside.
struct VoxelBox {
  std::array<std::int64_t, 3> low, high;

  bool operator==(const VoxelBox&) const = default;
};

/// Voxels that were grown together, and its points once clusters are merged.
struct Cluster {
  std::vector<std::uint32_t> voxels;  ///< numbers in VoxelizedScan
  VoxelBox box{};                     ///< of `voxels`, relative to the map's frame
  std::size_t points = 0;             ///< also of clusters that were merged into this one
};

inline constexpr std::uint32_t kNoCluster = ~std::uint32_t{0};

/// The clusters of a scan and, per point, the number of its own.
struct Clusters {
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> of_point;  ///< kNoCluster where there is none
};

/// Returns whether boxes grown by half a voxel overlap within `margin_voxels`. The authors' test
/// compares the lower z of `a` with the upper x of `b`, and so may reject.
bool overlap(const VoxelBox& a, const VoxelBox& b, double margin_voxels, BoxTest test);

/// Grows clusters from the seeds, which are voxels of the scan, by block slot. A voxel of the scan
/// that shares a face with a seed of the cluster joins it; if it is a seed, too, the cluster grows
/// on from it. Each voxel belongs to the first cluster that reaches it. Clusters begin at seeds in
/// the order of blocks, then of voxels, z before y before x. Then each cluster takes in all later
/// ones whose boxes overlap with its box and that have a voxel within cluster_separation_voxels of
/// one of its own voxels, not of those that joined. Clusters with too few or too many points, or
/// too small or large a box, are dropped.
Clusters find_clusters(const VoxelizedScan& scan, std::span<const BlockMask> seeds,
                       const VoxelGrid& grid, const Config& config);

/// Follows the centres of objects from scan to scan.
class Tracks {
 public:
  explicit Tracks(double max_distance_m) : max_distance_m_(max_distance_m) {}

  struct Track {
    std::uint32_t number = 0;  ///< from 1, never given to another object
    std::uint32_t scans = 0;   ///< in which it was seen before
  };
  /// Returns the tracks of this scan's centres, in the map frame. The nearest pair of a centre and
  /// one of the scan before is one object if at most max_distance apart, then the next nearest
  /// among the rest. The authors give a lost object's number to a new one; here it is not used
  /// again.
  std::vector<Track> follow(const std::vector<Eigen::Vector3d>& centres_m);

 private:
  double max_distance_m_;
  std::vector<Eigen::Vector3d> previous_m_;
  std::vector<Track> tracks_;  // of the previous centres
  std::uint32_t last_number_ = 0;
};

}  // namespace mosbench::dynablox
