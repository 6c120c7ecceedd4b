#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace mosbench {

/// Index of a voxel, relative to the origin of its VoxelGrid.
struct Voxel {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const Voxel&) const = default;
};

/// Voxels are stored in cubic blocks of 8x8x8, so that one bit per voxel fills a cache line.
inline constexpr int kBlockSide = 8;
inline constexpr int kBlockVoxels = 512;

/// Index of a block: the voxel index divided by 8, rounded down.
struct BlockIndex {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const BlockIndex&) const = default;
};

inline BlockIndex block_of(const Voxel& v) { return {v.x >> 3, v.y >> 3, v.z >> 3}; }

/// Position of a voxel in its block, x fastest: 0 to 511.
inline std::uint32_t cell_of(const Voxel& v) {
  return static_cast<std::uint32_t>(((v.z & 7) << 6) | ((v.y & 7) << 3) | (v.x & 7));
}

inline Voxel voxel_at(const BlockIndex& block, std::uint32_t cell) {
  return {block.x * 8 + static_cast<std::int32_t>(cell & 7),
          block.y * 8 + static_cast<std::int32_t>((cell >> 3) & 7),
          block.z * 8 + static_cast<std::int32_t>(cell >> 6)};
}

/// One bit per voxel of a block: word z, bit y * 8 + x.
struct alignas(64) BlockMask {
  std::array<std::uint64_t, 8> words{};

  bool test(std::uint32_t cell) const { return (words[cell >> 6] >> (cell & 63)) & 1u; }
  void set(std::uint32_t cell) { words[cell >> 6] |= std::uint64_t{1} << (cell & 63); }
  bool any() const {
    std::uint64_t bits = 0;
    for (const std::uint64_t word : words) bits |= word;
    return bits != 0;
  }
  std::size_t count() const {
    // Without a flag for newer machines std::popcount would be a call for each word.
    std::uint64_t total = 0;
    for (std::uint64_t word : words) {
      word -= word >> 1 & 0x5555555555555555u;
      word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
      total += (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0Fu;  // bytes stay below 8 * 8 + 1
    }
    total = (total & 0x00FF00FF00FF00FFu) + (total >> 8 & 0x00FF00FF00FF00FFu);
    return static_cast<std::size_t>(total * 0x0001000100010001u >> 48);
  }
  bool operator==(const BlockMask&) const = default;
};

template <typename Combine>
BlockMask combine(const BlockMask& a, const BlockMask& b, Combine combine_words) {
  BlockMask result;
  for (std::size_t z = 0; z < 8; ++z) result.words[z] = combine_words(a.words[z], b.words[z]);
  return result;
}
inline BlockMask operator&(const BlockMask& a, const BlockMask& b) {
  return combine(a, b, [](auto p, auto q) { return p & q; });
}
inline BlockMask operator|(const BlockMask& a, const BlockMask& b) {
  return combine(a, b, [](auto p, auto q) { return p | q; });
}
/// The voxels of a that are not in b.
inline BlockMask without(const BlockMask& a, const BlockMask& b) {
  return combine(a, b, [](auto p, auto q) { return p & ~q; });
}
inline BlockMask operator~(const BlockMask& a) {
  return without(BlockMask{{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull}}, a);
}

/// The voxels x = 0 and x = 7 of a word of a mask.
inline constexpr std::uint64_t kFirstColumn = 0x0101010101010101u, kLastColumn = kFirstColumn << 7;

/// Returns the voxels of a word of a mask that have one of its own beside them in their row.
inline std::uint64_t beside_in_row(std::uint64_t word) {
  return (word << 1 & ~kFirstColumn) | (word >> 1 & ~kLastColumn);
}

/// Calls visit(cell) for every set voxel in rising order.
template <typename Visit>
void for_each_cell(const BlockMask& mask, Visit&& visit) {
  for (std::uint32_t z = 0; z < 8; ++z) {
    for (std::uint64_t word = mask.words[z]; word != 0; word &= word - 1) {
      visit(z * 64 + static_cast<std::uint32_t>(std::countr_zero(word)));
    }
  }
}

/// Where voxels lie in the map frame. Indices are kept small by an origin near the first scan, so
/// that projected coordinates of any size fit.
struct VoxelGrid {
  double voxel_size_m = 0;
  Eigen::Vector3d origin_voxels = Eigen::Vector3d::Zero();  ///< whole numbers, multiples of 8

  /// Lower corner v * Delta in the map frame, metres.
  Eigen::Vector3d corner_m(const Voxel& v) const {
    return {(origin_voxels.x() + v.x) * voxel_size_m, (origin_voxels.y() + v.y) * voxel_size_m,
            (origin_voxels.z() + v.z) * voxel_size_m};
  }
};

/// The voxels of `mask` with |v Delta - sensor|^2 <= range^2.
BlockMask within_range(const VoxelGrid& grid, const BlockIndex& block, const BlockMask& mask,
                       const Eigen::Vector3d& sensor_m, double range_m);

}  // namespace mosbench
