#include "core/halo.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

/// Places eight bits at a signed position of a row.
std::uint64_t placed(std::uint64_t byte, int position) {
  return position >= 0 ? byte << position : byte >> -position;
}

}  // namespace

void gather_halo(std::span<const BlockMask* const> masks, int radius, HaloRows& halo) {
  const int reach = reach_of_halo(radius), blocks = 2 * reach + 1;
  halo.radius = radius;
  halo.side = kBlockSide + 2 * radius;
  halo.rows.assign(static_cast<std::size_t>(halo.side * halo.side), 0);
  const std::uint64_t row_mask = ~std::uint64_t{0} >> (64 - halo.side);
  std::uint64_t any = 0;
  for (int z = -radius; z < kBlockSide + radius; ++z) {
    const auto word = static_cast<std::size_t>(z & 7);
    for (int by = -reach; by <= reach; ++by) {
      const std::size_t first_mask =
          static_cast<std::size_t>((((z >> 3) + reach) * blocks + by + reach) * blocks);
      for (int bx = -reach; bx <= reach; ++bx) {
        const BlockMask* mask = masks[first_mask + static_cast<std::size_t>(bx + reach)];
        if (mask == nullptr || mask->words[word] == 0) continue;
        const int first_y = std::max(by * kBlockSide, -radius);
        const int last_y = std::min(by * kBlockSide + kBlockSide, kBlockSide + radius);
        const int position = bx * kBlockSide + radius;
        std::uint64_t* rows = &halo.rows[static_cast<std::size_t>((z + radius) * halo.side)];
        std::uint64_t bits = mask->words[word] >> ((first_y & 7) * 8);
        for (int y = first_y; y < last_y; ++y, bits >>= 8) {
          const std::uint64_t row = placed(bits & 0xFFu, position) & row_mask;
          rows[y + radius] |= row;
          any |= row;
        }
      }
    }
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
