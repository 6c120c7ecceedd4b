#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hmm_mos_plus/scan_masks.hpp"

namespace mosbench::hmm_mos_plus {

/// The lowest occupied voxel in each column of a scan, which must outlive it.
class Ground {
 public:
  explicit Ground(const VoxelizedScan& scan);

  /// Returns the low voxels, masks in the order of scan.measured.blocks: occupied ones at most
  /// `layers` above the lowest occupied voxel in the columns within `radius` per axis, which is
  /// from 0 to kBlockSide.
  ScanMasks low_voxels(int radius, int layers) const;
  /// Returns, for each column from `first` to `last`, both included, x first, the height of the
  /// lowest voxel in the columns within `radius` per axis; the greatest number where there is none.
  std::vector<std::int32_t> lowest_within(int radius, const Voxel& first, const Voxel& last) const;

 private:
  /// Heights of the columns of a stack of blocks, y * 8 + x.
  using Tile = std::array<std::int32_t, std::size_t{kBlockSide} * kBlockSide>;

  std::size_t slot_of(const BlockIndex& block);
  Tile lowest_around(const BlockIndex& at, int radius) const;
  std::vector<std::int32_t> columns(const Voxel& first, const Voxel& last) const;

  const VoxelizedScan& scan_;
  BlockTable table_;                // of {x, y, 0}
  std::vector<BlockIndex> blocks_;  // of the tiles
  std::vector<Tile> lowest_;
  std::vector<std::size_t> tile_of_;  // of the scan's blocks
};

}  // namespace mosbench::hmm_mos_plus
