#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// Squared voxels; stands for every distance of radius + 1 voxels or more.
constexpr int far_squared(int radius) { return (radius + 1) * (radius + 1); }

/// Distances from the cells of a block.
struct BlockDistances {
  BlockMask near;  ///< cells with a source at less than radius + 1 voxels
  /// Squared voxels. far_squared for other cells of a layer with a near one; not set in other
  /// layers.
  std::array<std::uint16_t, kBlockVoxels> squared;
};

/// The source voxels of a block.
struct SourceBlock {
  void add(const BlockMask& sources);

  BlockMask mask;
  std::uint64_t rows = 0;  ///< byte z, bit y: whether that row has any
};

/// Widest radius of a distance field, voxels.
inline constexpr int kMaxDistanceRadius = 28;

/// Squared Euclidean distances d_i^2 / Delta^2 (EDF; paper, III) from every cell of a block to the
/// nearest source voxel, as far as they are below (radius + 1)^2. Exact and separable, one axis
/// after the other, as in P. Felzenszwalb and D. Huttenlocher, "Distance Transforms of Sampled
/// Functions", 2012: min over u of |v - u|^2 = min over z of ((v_z - z)^2 + min over y of ((v_y -
/// y)^2 + min over x of (v_x - x)^2)). Within so small a radius the minimum along x is a look-up,
/// and those along y and z try every offset. Shared by threads.
class DistanceField {
 public:
  /// `radius` from 0 to kMaxDistanceRadius.
  explicit DistanceField(int radius);
  int radius() const { return radius_; }
  /// Blocks per direction that may hold a source within the radius: 1 or more.
  int reach() const { return reach_; }

  /// Look-ups of one number type. [block along x * 256 + its eight bits]: squared x distances of
  /// the eight cells of a row. [row + radius]: squared y distances of the 64 cells of a plane.
  template <typename Distance>
  struct Tables {
    std::vector<std::array<Distance, kBlockSide>> along_x;
    std::vector<std::array<Distance, kBlockSide * kBlockSide>> along_y;
  };

 private:
  friend class ColumnDistances;
  int radius_, reach_;
  Tables<std::uint8_t> narrow_;  // while (radius + 1)^2 + (radius + 7)^2 fits a byte
  Tables<std::uint16_t> wide_;
};

/// Computes the distance field of one block after another. For a block above the last one, layers
/// that both need are reused; raycast's list has up to four blocks of a column in a row, from
/// below.
class ColumnDistances {
 public:
  explicit ColumnDistances(const DistanceField& field) : field_(field) {}

  /// `sources` are the cube of (2 reach + 1)^3 blocks around the block, x fastest; they stay the
  /// same over the life of this. Looks at layers with a `wanted` cell only; no cell of another one
  /// is near.
  void find(const BlockIndex& block, const BlockMask& wanted,
            std::span<const SourceBlock* const> sources, BlockDistances& distances);

  static constexpr int kMaxLayers = kBlockSide + 2 * kMaxDistanceRadius;
  static constexpr std::size_t kMaxPlaneBytes = kBlockSide * kBlockSide * sizeof(std::uint16_t);
  /// Distances from the cells of a plane to the sources of each layer z, at z % kMaxLayers.
  struct Layers {
    std::uint64_t known = 0, filled = 0;  ///< computed; having sources
    alignas(32) std::array<std::uint8_t, kMaxLayers * kMaxPlaneBytes> planes;
  };

 private:
  const DistanceField& field_;
  std::optional<BlockIndex> last_;
  Layers layers_;
};

/// The union of voxel sets over a box of blocks, addressed without hashing.
class SourceGrid {
 public:
  /// The box spans `blocks` and `margin` blocks around them; voxels outside of it are left out.
  SourceGrid(std::span<const VoxelSet* const> sets, std::span<const BlockIndex> blocks, int margin);

  /// Whether any of the (2 reach + 1)^3 blocks around holds a voxel.
  bool any_around(const BlockIndex& block, int reach) const {
    const auto width = static_cast<std::size_t>(2 * reach + 1);
    for (int dz = -reach; dz <= reach; ++dz) {
      for (int dy = -reach; dy <= reach; ++dy) {
        const std::size_t first = position({block.x - reach, block.y + dy, block.z + dz});
        for (std::size_t i = 0; i < width; ++i) {
          if (slots_[first + i] != kEmpty) return true;
        }
      }
    }
    return false;
  }

  /// Finds the (2 reach + 1)^3 blocks around, x fastest. The block must lie in the box.
  void neighbours(const BlockIndex& block, int reach, std::span<const SourceBlock*> around) const {
    const auto width = static_cast<std::size_t>(2 * reach + 1);
    std::size_t i = 0;
    for (int dz = -reach; dz <= reach; ++dz) {
      for (int dy = -reach; dy <= reach; ++dy) {
        const std::size_t first = position({block.x - reach, block.y + dy, block.z + dz});
        for (std::size_t dx = 0; dx < width; ++dx) around[i++] = &sources_[slots_[first + dx]];
      }
    }
  }

 private:
  static constexpr std::uint32_t kEmpty = 0;  // the slot of a block without voxels

  std::size_t position(const BlockIndex& block) const {
    return (static_cast<std::size_t>(block.z - low_[2]) * sides_[1] +
            static_cast<std::size_t>(block.y - low_[1])) *
               sides_[0] +
           static_cast<std::size_t>(block.x - low_[0]);
  }

  std::array<std::int32_t, 3> low_{};
  std::array<std::size_t, 3> sides_{};
  std::vector<std::uint32_t> slots_;
  std::vector<SourceBlock> sources_;
};

}  // namespace mosbench
