#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/slot_pool.hpp"
#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// What detection found about a scan; the masks of `beside_unknown` need to be right only where
/// the scan's voxels are dynamic or lie within a block of the region.
struct DetectedScan {
  const VoxelizedScan& scan;
  const VoxelSet& dynamic;      ///< before the back-end added any
  const VoxelSet& from_region;  ///< chosen by the back-end
  const VoxelSet& beside_unknown;
  std::optional<double> threshold;  ///< T
};

/// The voxels found dynamic in the last w_d scans (paper-2024 only). Voxels that are not dynamic
/// need no record: nothing depends on them beyond the scan in which they are visited.
class DynamicRegion {
 public:
  DynamicRegion(const VoxelGrid& grid, double max_range_m, int dynamic_window_scans,
                int min_otsu_score);

  /// algorithm step 5g: of `candidates` (occupied voxels not beside unknown), those with more
  /// high-confidence voxels among their m^3 neighbours than Otsu's threshold.
  VoxelSet back_end(const VoxelizedScan& scan, const VoxelSet& beside_unknown,
                    int kernel_width_voxels, ThreadPool& pool) const;

  /// algorithm step 6 at time `scan_index`; may be called twice with the same time.
  void update(const DetectedScan& detected, std::uint32_t scan_index);

  /// Blocks with any dynamic voxel.
  std::vector<BlockIndex> blocks() const;
  std::size_t memory_bytes() const { return blocks_.memory_bytes() + table_.memory_bytes(); }

 private:
  struct Block {
    BlockIndex index;
    bool live = false;
    BlockMask dynamic, beside_unknown, high_confidence;
    std::array<std::uint8_t, kBlockVoxels> neighbours;  // dynamic voxels among the 27
    std::array<std::uint16_t, kBlockVoxels> became;     // scan modulo 2^16
  };

  void visit(const DetectedScan& detected, std::uint32_t scan_index);
  void add(const Voxel& voxel, std::uint32_t scan_index);
  void remove(Block& block, std::uint32_t cell);
  template <typename Visit>
  void for_each_dynamic_neighbour(const Voxel& voxel, Visit&& visit);
  void evict(const Eigen::Vector3d& sensor_m, std::uint32_t scan_index);
  Block* find(const BlockIndex& block);

  VoxelGrid grid_;
  double evict_radius_m_;
  std::uint32_t dynamic_window_scans_;
  int min_otsu_score_;
  BlockTable table_;
  Pool<Block> blocks_;
  std::array<std::size_t, 28> count_by_neighbours_{};  // of all dynamic voxels
  double threshold_ = 0;                               // T_R, kept while no level is found
  VoxelSet visited_;  // occupied, not dynamic voxels that visited_at_ has seen
  std::uint32_t visited_at_ = 0;
};

}  // namespace mosbench::hmm_mos
