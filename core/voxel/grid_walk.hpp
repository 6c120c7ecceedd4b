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
  explicit WindowBits(const RayWindow& window)
      : y_shift_(window.y_shift()),
        z_shift_(window.z_shift()),
        along_y_(window.bytes_along() == RayWindow::BytesAlong::kY) {
    const auto below = [](int bit) { return (std::uint64_t{1} << bit) - 1; };
    axes_[0] = 7 | (below(y_shift_) & ~below(10)) << 3;
    axes_[1] = (7 | 3 << 8 | (below(z_shift_) & ~below(y_shift_))) << 3;
    axes_[2] = (below(8) & ~below(3)) << 3 | (below(58) & ~below(z_shift_)) << 3;
    if (!along_y_) return;
    axes_[0] ^= 7 | 7 << 3;
    axes_[1] ^= 7 | 7 << 3;
  }

  /// Returns the bit of a voxel, counted from the low corner of the window.
  std::uint64_t at(const Voxel& from_corner) const {
    constexpr int kFraction = 8;  // what address_of wants
    const auto scaled = [](std::int32_t index) {
      return std::uint64_t{static_cast<std::uint32_t>(index)} << kFraction;
    };
    const std::int32_t swapped = along_y_ ? (from_corner.x ^ from_corner.y) & 7 : 0;
    const std::int32_t x = from_corner.x ^ swapped, y = from_corner.y ^ swapped;
    const std::uint64_t byte =
        address_of<kFraction>(scaled(x), scaled(y), scaled(from_corner.z), y_shift_, z_shift_);
    return byte << 3 | static_cast<std::uint64_t>(x & 7);
  }

  /// Returns the bits of an axis.
  std::uint64_t of_axis(std::size_t axis) const { return axes_[axis]; }
  /// Returns what a step adds to the bits of an axis. Forward, the bits of the other axes are
  /// added as ones, so that they hand the carry on.
  std::uint64_t change(std::size_t axis, bool back) const { return change_of(axes_[axis], back); }
  /// The same for some bits of an axis.
  static std::uint64_t change_of(std::uint64_t own, bool back) {
    const std::uint64_t lowest = own & (~own + 1);
    return back ? ~lowest + 1 : ~own + lowest;
  }
  /// Returns the bit of the next voxel along an axis.
  std::uint64_t next(std::uint64_t bit, std::size_t axis, bool back) const {
    const std::uint64_t own = axes_[axis];
    return (((bit & own) + change(axis, back)) & own) | (bit & ~own);
  }

 private:
  int y_shift_, z_shift_;
  bool along_y_;
  std::array<std::uint64_t, 3> axes_;
};

/// A line on its way through a window.
class WindowWalk {
 public:
  WindowWalk(const WindowBits& bits, std::uint64_t start, const BorderCrossings& crossings)
      : bits_(bits), crossings_(crossings), at_(start) {}

  std::uint64_t at() const { return at_; }
  double nearest_m() const { return crossings_.nearest_m(); }
  double next_m(std::size_t axis) const { return crossings_.next_m[axis]; }

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
inline BlockIndex lay_out_around(const VoxelBox& box, RayWindow& window,
                                 RayWindow::BytesAlong bytes = RayWindow::BytesAlong::kX) {
  const BlockIndex first = block_of(box.low);
  const auto tiles = [](std::int32_t first_block, std::int32_t high) {
    const std::int32_t extent = high - first_block * kBlockSide;
    return static_cast<int>(
        std::bit_width(static_cast<std::uint32_t>(extent / RayWindow::kTileSide)));
  };
  window.lay_out(
      {tiles(first.x, box.high.x), tiles(first.y, box.high.y), tiles(first.z, box.high.z)}, bytes);
  return first;
}

}  // namespace mosbench
