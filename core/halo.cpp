#include "core/halo.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

/// `Reach` is a number or, for the common one, a constant that unrolls the inner loop.
template <typename Reach>
inline void gather(std::span<const BlockMask* const> masks, Reach reach, int radius,
                   HaloRows& halo) {
  const int blocks = 2 * reach + 1;
  const std::uint64_t row_mask = ~std::uint64_t{0} >> (64 - halo.side);
  // Rows are put together from the lowest x bit that any of the blocks has.
  const int skipped = reach * kBlockSide - radius;
  std::array<std::uint64_t, 2 * ((kMaxHalo + 7) / kBlockSide) + 1> words{};
  std::uint64_t any = 0;
  std::uint64_t* row = halo.rows.data();
  for (int z = -radius; z < kBlockSide + radius; ++z) {
    for (int by = -reach; by <= reach; ++by) {
      const int first_y = std::max(by * kBlockSide, -radius);
      const int last_y = std::min(by * kBlockSide + kBlockSide, kBlockSide + radius);
      const std::size_t first =
          static_cast<std::size_t>((((z >> 3) + reach) * blocks + by + reach) * blocks);
      std::uint64_t any_here = 0;
      for (std::size_t bx = 0; bx < static_cast<std::size_t>(blocks); ++bx) {
        const BlockMask* mask = masks[first + bx];
        words[bx] = mask == nullptr ? 0 : mask->words[static_cast<std::size_t>(z & 7)];
        any_here |= words[bx];
      }
      if (any_here == 0) {
        row = std::fill_n(row, last_y - first_y, std::uint64_t{0});
        continue;
      }
      for (int y = first_y; y < last_y; ++y) {
        std::uint64_t bits = (words[0] >> ((y & 7) * 8) & 0xFFu) >> skipped;
        for (int bx = 1; bx < blocks; ++bx) {
          bits |= (words[static_cast<std::size_t>(bx)] >> ((y & 7) * 8) & 0xFFu)
                  << (bx * kBlockSide - skipped);
        }
        *row = bits & row_mask;
        any |= *row++;
      }
    }
  }
  halo.any = any != 0;
}

}  // namespace

void gather_halo(std::span<const BlockMask* const> masks, int radius, HaloRows& halo) {
  halo.radius = radius;
  halo.side = kBlockSide + 2 * radius;
  halo.rows.resize(static_cast<std::size_t>(halo.side * halo.side));
  if (reach_of_halo(radius) == 1) {
    gather(masks, std::integral_constant<int, 1>{}, radius, halo);
  } else {
    gather(masks, reach_of_halo(radius), radius, halo);
  }
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
