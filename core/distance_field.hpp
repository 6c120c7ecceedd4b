#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/halo.hpp"

namespace mosbench {

/// Squared distance in voxels from each cell of a block.
using BlockDistances = std::array<std::uint16_t, kBlockVoxels>;

/// Cells with a distance below the limit.
BlockMask cells_below(const BlockDistances& distances, std::size_t limit);

/// Squared Euclidean distances d^2 / Delta^2 from every cell of a block to the nearest source
/// voxel: exact below (radius + 1)^2; what is not below may be any number that is not either.
/// Separable: rows by look-up, then the lower envelope along y and along z.
class DistanceField {
 public:
  /// `radius` from 0 to kMaxHalo.
  explicit DistanceField(int radius);
  int radius() const { return radius_; }

  /// `sources` must have been gathered with this radius.
  void squared_distances(const HaloRows& sources, BlockDistances& distances) const;

 private:
  template <typename Distance>
  using RowTable = std::vector<std::array<Distance, kBlockSide>>;

  int radius_;
  // Entry [8-bit piece * 256 + its bits]: squared x distances of the eight cells of a row.
  RowTable<std::uint8_t> narrow_;  // while (radius + 1)^2 + (radius + 7)^2 fits a byte
  RowTable<std::uint16_t> wide_;
};

}  // namespace mosbench
