#include "core/halo.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

using Bytes = std::array<std::uint8_t, kBlockSide>;

Bytes rows_of(const BlockMask* mask, int z) {
  Bytes bytes{};
  if (mask != nullptr) std::memcpy(bytes.data(), &mask->words[static_cast<std::size_t>(z)], 8);
  return bytes;
}

/// Joins the rows of three blocks side by side, for halos within the next block.
inline void join_three(const Bytes& low, const Bytes& middle, const Bytes& high, int skipped,
                       std::uint64_t row_mask, std::uint64_t* rows) {
  for (std::size_t y = 0; y < kBlockSide; ++y) {
    const std::uint64_t wide =
        std::uint64_t{low[y]} | std::uint64_t{middle[y]} << 8 | std::uint64_t{high[y]} << 16;
    rows[y] = wide >> skipped & row_mask;
  }
}

/// Adds the rows of one block at bit `position`, which may lie below zero.
inline void add_rows(const Bytes& bytes, int position, std::uint64_t row_mask,
                     std::uint64_t* rows) {
  for (std::size_t y = 0; y < kBlockSide; ++y) {
    const std::uint64_t byte = bytes[y];
    rows[y] |= (position >= 0 ? byte << position : byte >> -position) & row_mask;
  }
}

}  // namespace

MOSBENCH_MULTIARCH void gather_halo(std::span<const BlockMask* const> masks, int radius,
                                    HaloRows& halo) {
  const int reach = reach_of_halo(radius), blocks = 2 * reach + 1;
  halo.radius = radius;
  halo.side = kBlockSide + 2 * radius;
  halo.stride = blocks * kBlockSide;
  halo.first = reach * kBlockSide - radius;
  halo.rows.assign(static_cast<std::size_t>(halo.side * halo.stride), 0);
  const std::uint64_t row_mask = ~std::uint64_t{0} >> (64 - halo.side);
  std::uint64_t any = 0;
  for (int z = 0; z < halo.side; ++z) {
    const int map_z = z - radius;
    for (int by = 0; by < blocks; ++by) {
      const BlockMask* const* side_by_side =
          &masks[static_cast<std::size_t>((((map_z >> 3) + reach) * blocks + by) * blocks)];
      std::uint64_t* rows = &halo.rows[static_cast<std::size_t>(z * halo.stride + by * kBlockSide)];
      if (reach == 1) {
        join_three(rows_of(side_by_side[0], map_z & 7), rows_of(side_by_side[1], map_z & 7),
                   rows_of(side_by_side[2], map_z & 7), halo.first, row_mask, rows);
      } else {
        for (int bx = 0; bx < blocks; ++bx) {
          add_rows(rows_of(side_by_side[bx], map_z & 7), bx * kBlockSide - halo.first, row_mask,
                   rows);
        }
      }
    }
    for (int y = 0; y < halo.side; ++y) any |= halo.row(z, y);
  }
  halo.any = any != 0;
}

BlockMask dilate(const HaloRows& halo) {
  BlockMask result;
  if (!halo.any) return result;
  const int width = 2 * halo.radius + 1;
  std::array<std::uint64_t, kBlockSide + 2 * kMaxHalo> spread{};
  for (int z = 0; z < halo.side; ++z) {
    std::uint64_t any = 0;
    for (int y = 0; y < halo.side; ++y) {
      std::uint64_t bits = 0;
      const std::uint64_t row = halo.row(z, y);
      for (int i = 0; i < width; ++i) bits |= row >> i;
      spread[static_cast<std::size_t>(y)] = bits & 0xFFu;
      any |= bits;
    }
    if ((any & 0xFFu) == 0) continue;
    std::uint64_t plane = 0;
    for (int y = 0; y < kBlockSide; ++y) {
      std::uint64_t united = 0;
      for (int i = 0; i < width; ++i) united |= spread[static_cast<std::size_t>(y + i)];
      plane |= united << (y * 8);
    }
    for (int out = std::max(0, z - width + 1); out <= std::min(kBlockSide - 1, z); ++out) {
      result.words[static_cast<std::size_t>(out)] |= plane;
    }
  }
  return result;
}

MOSBENCH_MULTIARCH int count_around(const HaloRows& halo, std::uint32_t cell) {
  const int x = static_cast<int>(cell & 7), y = static_cast<int>((cell >> 3) & 7),
            z = static_cast<int>(cell >> 6);
  const int width = 2 * halo.radius + 1;
  const std::uint64_t row_mask = (std::uint64_t{1} << width) - 1;
  int count = 0;
  for (int dz = 0; dz < width; ++dz) {
    for (int dy = 0; dy < width; ++dy) {
      count += std::popcount((halo.row(z + dz, y + dy) >> x) & row_mask);
    }
  }
  return count;
}

}  // namespace mosbench
