#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/voxel/ray_window.hpp"
#include "core/voxel/voxel.hpp"

/// Voxels on the exact line between two positions, one after another (Amanatides and Woo 1987),
/// where raycast.hpp has Bresenham's between voxels.
namespace mosbench {

/// Where a line crosses borders of voxels next: per axis its length up to there, and between two of
/// them. Rounded as in OctoMap's computeRayKeys, which takes `from` and `direction` in single
/// precision.
struct BorderCrossings {
  std::array<double, 3> next_m, pace_m;
  std::array<bool, 3> back;  ///< towards lower coordinates

  /// `from` lies in the voxel `start` of a grid with a corner at 0; `direction` has length 1.
  BorderCrossings(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction,
                  const Voxel& start, double voxel_size_m) {
    const std::array<std::int32_t, 3> index{start.x, start.y, start.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      back[i] = direction[axis] < 0;
      next_m[i] = pace_m[i] = std::numeric_limits<double>::max();
      if (direction[axis] == 0) continue;
      const double half_m = (back[i] ? -1 : 1) * voxel_size_m * 0.5;
      const double border_m = (index[i] + 0.5) * voxel_size_m + static_cast<float>(half_m);
      next_m[i] = (border_m - from_m[axis]) / direction[axis];
      pace_m[i] = voxel_size_m / std::abs(direction[axis]);
    }
  }

  /// Returns the axis whose border comes next.
  std::size_t axis() const {
    if (next_m[0] < next_m[1]) return next_m[0] < next_m[2] ? 0 : 2;
    return next_m[1] < next_m[2] ? 1 : 2;
  }
  /// Returns the length of the line up to the next border.
  double nearest_m() const { return std::min(std::min(next_m[0], next_m[1]), next_m[2]); }
};

/// Addresses of the bits of a RayWindow: 8 * byte + bit. A step along an axis changes the bits of
/// that axis alone.
class WindowBits {
 public:
  explicit WindowBits(const RayWindow& window) {
    const auto below = [](int bit) { return (std::uint64_t{1} << bit) - 1; };
    const int y = window.y_shift(), z = window.z_shift();
    axes_[0] = 7 | (below(y) & ~below(10)) << 3;
    axes_[1] = (7 | 3 << 8 | (below(z) & ~below(y))) << 3;
    axes_[2] = (below(8) & ~below(3)) << 3 | (below(58) & ~below(z)) << 3;
  }

  /// Returns the bit of a voxel, counted from the low corner of the window.
  std::uint64_t at(const Voxel& from_corner) const {
    const std::array<std::int32_t, 3> index{from_corner.x, from_corner.y, from_corner.z};
    std::uint64_t bit = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint64_t rest = axes_[i];
      for (auto digits = static_cast<std::uint32_t>(index[i]); digits != 0; digits >>= 1) {
        if ((digits & 1) != 0) bit |= rest & (~rest + 1);
        rest &= rest - 1;
      }
    }
    return bit;
  }

  /// Returns the bits of an axis.
  std::uint64_t of_axis(std::size_t axis) const { return axes_[axis]; }
  /// Returns what a step adds to the bits of an axis. Forward, the bits of the other axes are
  /// added as ones, so that they hand the carry on.
  std::uint64_t change(std::size_t axis, bool back) const {
    const std::uint64_t own = axes_[axis];
    const std::uint64_t lowest = own & (~own + 1);
    return back ? ~lowest + 1 : ~own + lowest;
  }
  /// Returns the bit of the next voxel along an axis.
  std::uint64_t next(std::uint64_t bit, std::size_t axis, bool back) const {
    const std::uint64_t own = axes_[axis];
    return (((bit & own) + change(axis, back)) & own) | (bit & ~own);
  }

 private:
  std::array<std::uint64_t, 3> axes_;
};

/// A line on its way through a window.
class WindowWalk {
 public:
  WindowWalk(const WindowBits& bits, std::uint64_t start, const BorderCrossings& crossings)
      : bits_(bits), crossings_(crossings), at_(start) {}

  std::uint64_t at() const { return at_; }
  double nearest_m() const { return crossings_.nearest_m(); }

  /// Moves to the next voxel and returns along which axis.
  std::size_t advance() {
    const std::size_t axis = crossings_.axis();
    at_ = bits_.next(at_, axis, crossings_.back[axis]);
    crossings_.next_m[axis] += crossings_.pace_m[axis];
    return axis;
  }

 private:
  const WindowBits& bits_;
  BorderCrossings crossings_;
  std::uint64_t at_;
};

/// Sets bits of a window and keeps the record of its tiles.
class WindowPen {
 public:
  explicit WindowPen(RayWindow& window) : bits_(window.bits()), tiles_(window.tiles()) {}

  void mark(std::uint64_t bit) {
    bits_[bit >> 3] |= static_cast<std::uint8_t>(1u << (bit & 7));
    const auto tile = static_cast<std::uint32_t>((bit >> 3) / RayWindow::kTileBytes);
    if (tile == tile_) return;
    tiles_.touch_between(tile, tile);
    tile_ = tile;
  }

 private:
  std::uint8_t* bits_;
  RayWindow::Tiles tiles_;
  std::uint32_t tile_ = ~std::uint32_t{0};
};

/// A box of voxels, both corners in it.
struct VoxelBox {
  Voxel low, high;

  void include(const Voxel& v) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  void widen(std::int32_t voxels) {
    low = {low.x - voxels, low.y - voxels, low.z - voxels};
    high = {high.x + voxels, high.y + voxels, high.z + voxels};
  }
};

/// Lays a window out around a box. Returns the block at its low corner.
inline BlockIndex lay_out_around(const VoxelBox& box, RayWindow& window) {
  const BlockIndex first = block_of(box.low);
  const auto tiles = [](std::int32_t first_block, std::int32_t high) {
    const std::int32_t extent = high - first_block * kBlockSide;
    return static_cast<int>(
        std::bit_width(static_cast<std::uint32_t>(extent / RayWindow::kTileSide)));
  };
  window.lay_out(
      {tiles(first.x, box.high.x), tiles(first.y, box.high.y), tiles(first.z, box.high.z)});
  return first;
}

}  // namespace mosbench
