#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// The findings of detection in a scan. `beside_unknown` need be complete only in and next to the
/// blocks of the region and of `dynamic`.
struct DetectedScan {
  const VoxelizedScan& scan;
  const VoxelSet& dynamic;      ///< before the back-end added any
  const VoxelSet& from_region;  ///< chosen by the back-end
  const VoxelSet& beside_unknown;
  std::optional<double> threshold;  ///< T
};

/// The dynamic window of the paper (III): voxels found dynamic in the last w_d scans, here called
/// the region (paper-2024 only). High-confidence voxels are those of its voxels, not beside unknown
/// ones, with more dynamic ones among the 27 around them than Otsu's threshold T_R on these counts.
/// Voxels that are not dynamic need no record: nothing depends on them beyond the scan that visits
/// them.
class DynamicRegion {
 public:
  DynamicRegion(const VoxelGrid& grid, double max_range_m, int dynamic_window_scans,
                int min_otsu_score);

  /// Returns the scan's occupied voxels that are not in `beside_unknown` and have more
  /// high-confidence voxels among the m^3 around them than Otsu's threshold on these counts.
  VoxelSet back_end(const VoxelizedScan& scan, const VoxelSet& beside_unknown,
                    int kernel_width_voxels, ThreadPool& pool) const;

  /// Takes in the dynamic voxels of a scan that was judged at time `scan_index`; forgets those
  /// older than w_d scans or beyond twice the range. The end of a delayed run calls it twice with
  /// the same time.
  void update(const DetectedScan& detected, std::uint32_t scan_index);

  /// Returns the blocks of the region and those of `dynamic`; some may come twice. In and next to
  /// them `back_end` and `update` ask for `beside_unknown`.
  std::vector<BlockIndex> blocks_with(const VoxelSet& dynamic) const;
  std::size_t memory_bytes() const { return blocks_.memory_bytes(); }

 private:
  struct Block {
    BlockMask dynamic, beside_unknown, high_confidence;
    std::array<std::uint8_t, kBlockVoxels> neighbours;  // dynamic voxels among the 27
    std::array<std::uint16_t, kBlockVoxels> became;     // scan modulo 2^16
  };

  void visit(const DetectedScan& detected, std::uint32_t scan_index);
  void add(const Voxel& voxel, std::uint32_t scan_index);
  void remove(std::uint32_t slot, std::uint32_t cell);
  template <typename Visit>
  void for_each_dynamic_neighbour(const Voxel& voxel, Visit&& visit);
  void evict(const Eigen::Vector3d& sensor_m, std::uint32_t scan_index);
  Block* find(const BlockIndex& block);

  VoxelGrid grid_;
  double evict_radius_m_;
  std::uint32_t dynamic_window_scans_;
  int min_otsu_score_;
  BlockMap<Block> blocks_;
  std::array<std::size_t, 28> count_by_neighbours_{};  // of all dynamic voxels
  double threshold_ = 0;                               // T_R, kept while no level is found
  VoxelSet visited_;  // occupied, non-dynamic voxels of scan `visited_at_`
  std::uint32_t visited_at_ = 0;
};

}  // namespace mosbench::hmm_mos
