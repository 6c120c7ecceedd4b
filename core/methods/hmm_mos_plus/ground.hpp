#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"

namespace mosbench::hmm_mos_plus {

/// The lowest occupied voxel in each column of a scan.
class Ground {
 public:
  Ground(const VoxelizedScan& scan, const Config& config);

  /// Returns the low ones among the scan's voxels in a block: at most ground_layers_voxels above
  /// the lowest occupied voxel in the columns within ground_radius_voxels per axis.
  BlockMask low_among(const BlockMask& voxels, const BlockIndex& block) const;
  /// Returns, for each column from `first` to `last`, both included, x first, the height of the
  /// lowest voxel in the columns within `radius` per axis; the greatest number where there is none.
  std::vector<std::int32_t> lowest_within(int radius, const Voxel& first, const Voxel& last) const;
  std::size_t memory_bytes() const {
    return table_.memory_bytes() + lowest_.capacity() * sizeof(Tile);
  }

 private:
  /// Heights of the columns of a stack of blocks, y * 8 + x.
  using Tile = std::array<std::int32_t, std::size_t{kBlockSide} * kBlockSide>;

  Tile& tile_of(const BlockIndex& block);
  Tile lowest_around(const BlockIndex& at) const;
  std::vector<std::int32_t> columns(const Voxel& first, const Voxel& last) const;

  int radius_, layers_;
  BlockTable table_;  // of {x, y, 0}
  std::vector<Tile> lowest_;
};

/// The low voxels of a scan, found block by block when they are first asked for: most are never.
/// `scan` and `ground` must outlive it.
class LowVoxels {
 public:
  LowVoxels(const VoxelizedScan& scan, const Ground& ground);

  /// Returns those of a block of the scan.
  const BlockMask& in(std::uint32_t slot);

 private:
  const VoxelizedScan& scan_;
  const Ground& ground_;
  ScanMasks low_;
  std::vector<std::uint8_t> found_;
};

}  // namespace mosbench::hmm_mos_plus
