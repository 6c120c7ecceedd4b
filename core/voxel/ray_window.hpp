#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench {

/// Bits of a box of voxels around the sensor, a byte for eight voxels along x, in tiles of 4x4x4
/// blocks (one page each). Numbers of tiles are powers of two, so that shifted coordinates make an
/// address:
///   y0-2 z0-2 z3-4 y3-4 x3-4 | x5.. y5.. z5..   (lowest address bit first; x0-2 is the bit)
/// Where bytes lie along y, x0-2 and y0-2 change places.
class RayWindow {
 public:
  enum class BytesAlong : std::uint8_t { kX, kY };
  static constexpr std::int32_t kTileSide = 32;
  static constexpr std::uint32_t kTileBytes = 4096;

  /// Zeroes nothing but the record of touched tiles: `collect` leaves the bits zero.
  void lay_out(const std::array<int, 3>& log2_tiles, BytesAlong axis = BytesAlong::kX);
  /// Copies the bits of a window of the same tiles whose bytes lie along the other axis.
  void copy_turned(const RayWindow& other);

  std::uint8_t* bits() const { return bits_.get(); }
  BytesAlong bytes_along() const { return bytes_along_; }
  int y_shift() const { return 12 + log2_tiles_[0]; }
  int z_shift() const { return y_shift() + log2_tiles_[1]; }

  /// Bits count only in touched tiles.
  class Tiles {
   public:
    /// Touches every tile that a line may have crossed between `a`, which was touched, and `b`,
    /// which lies at most one apart per axis; with a == b just this one.
    void touch_between(std::uint32_t a, std::uint32_t b) const {
      const std::uint32_t x = (a ^ b) & x_tiles_, y = (a ^ b) & y_tiles_,
                          z = (a ^ b) & ~(x_tiles_ | y_tiles_);
      // Seven unconditional stores cost less than one mispredicted branch.
      for (const std::uint32_t crossed : {x, y, z, x | y, x | z, y | z, x | y | z}) {
        touched_[a ^ crossed] = 1;
      }
    }

    /// Touches the tile of a byte.
    void touch(std::uint64_t byte) const { touched_[byte / kTileBytes] = 1; }

   private:
    friend class RayWindow;
    std::uint32_t x_tiles_ = 0, y_tiles_ = 0;
    std::uint8_t* touched_ = nullptr;
  };
  /// Until the next `lay_out`. A value, because a byte stored through it could change the window.
  Tiles tiles() const { return tiles_; }

  /// Bytes that rays ever touched; of small windows the rest may be resident, too.
  std::size_t memory_bytes() const;

 private:
  friend VoxelList collect(std::span<RayWindow> windows, const BlockIndex& first_block,
                           class ThreadPool& pool);
  BlockMask take(std::size_t byte);
  BlockIndex block_at(std::uint32_t tile, std::uint32_t block, const BlockIndex& first) const;

  struct Free {
    void operator()(std::uint8_t* pointer) const { std::free(pointer); }
  };
  std::array<int, 3> log2_tiles_{};  ///< along x, y, z
  BytesAlong bytes_along_ = BytesAlong::kX;
  Tiles tiles_;
  std::size_t capacity_tiles_ = 0;
  std::unique_ptr<std::uint8_t, Free> bits_;
  std::vector<std::uint8_t> touched_;   ///< in this scan, by tile
  std::vector<std::uint8_t> resident_;  ///< in any scan, by tile
};

/// Bits [first, first + count) of a coordinate with kFraction bits behind the point, moved to bit
/// `to`. `Number` is unsigned or a vector of such.
template <int kFraction, int first, int count, int to, typename Number>
inline __attribute__((always_inline)) Number moved_bits(const Number& at) {
  constexpr int shift = kFraction + first - to;
  static_assert(shift > 0);
  return at >> shift & ((1u << count) - 1) << to;
}

/// Byte address of a voxel in the window; the bit is x % 8.
template <int kFraction, typename Number>
inline __attribute__((always_inline)) Number address_of(const Number& x, const Number& y,
                                                        const Number& z, int y_shift, int z_shift) {
  const Number in_block = moved_bits<kFraction, 0, 3, 0>(y) | moved_bits<kFraction, 0, 5, 3>(z);
  const Number in_tile = moved_bits<kFraction, 3, 2, 8>(y) | moved_bits<kFraction, 3, 12, 10>(x);
  return (in_block | in_tile) +
         ((y >> (kFraction + 5) << y_shift) + (z >> (kFraction + 5) << z_shift));
}

/// Returns the voxels of all windows of the same tiles and clears the windows. `first_block` is the
/// block at their low corner.
VoxelList collect(std::span<RayWindow> windows, const BlockIndex& first_block, ThreadPool& pool);

}  // namespace mosbench
