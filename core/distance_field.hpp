#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel_set.hpp"

namespace mosbench {

/// Squared distance in voxels from each cell of a block.
using BlockDistances = std::array<std::uint16_t, kBlockVoxels>;

/// Cells with a distance below the limit.
BlockMask cells_below(const BlockDistances& distances, std::size_t limit);

/// Widest radius of a distance field, voxels.
inline constexpr int kMaxDistanceRadius = 28;

/// Squared Euclidean distances d^2 / Delta^2 from every cell of a block to the nearest source
/// voxel: exact below (radius + 1)^2; what is not below may be any number that is not either.
/// Separable: rows by look-up, then the lower envelope along y and along z.
class DistanceField {
 public:
  /// `radius` from 0 to kMaxDistanceRadius.
  explicit DistanceField(int radius);
  int radius() const { return radius_; }
  /// Blocks per direction that may hold a source within the radius: 1 or more.
  int reach() const { return reach_; }

  /// `sources` are the masks of the cube of (2 reach + 1)^3 blocks around the block, x fastest.
  /// False, and no distances, when no source lies within `radius` per axis.
  bool squared_distances(std::span<const BlockMask* const> sources,
                         BlockDistances& distances) const;

  /// Look-ups of one number type. [block along x * 256 + its eight bits]: squared x distances of
  /// the eight cells of a row. [row + radius]: squared y distances of the 64 cells of a plane.
  template <typename Distance>
  struct Tables {
    std::vector<std::array<Distance, kBlockSide>> along_x;
    std::vector<std::array<Distance, kBlockSide * kBlockSide>> along_y;
  };

 private:
  int radius_, reach_;
  Tables<std::uint8_t> narrow_;  // while (radius + 1)^2 + (radius + 7)^2 fits a byte
  Tables<std::uint16_t> wide_;
};

}  // namespace mosbench
