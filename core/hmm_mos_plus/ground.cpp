#include "core/hmm_mos_plus/ground.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace mosbench::hmm_mos_plus {
namespace {

constexpr std::size_t kSide = kBlockSide;
/// Heights of the columns of a stack of blocks, y * 8 + x.
using Tile = std::array<std::int32_t, kSide * kSide>;
constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();

struct Tiles {
  BlockTable table;  // of {x, y, 0}
  std::vector<BlockIndex> blocks;
  std::vector<Tile> lowest;

  std::size_t slot_of(const BlockIndex& block) {
    const auto fresh = static_cast<std::uint32_t>(blocks.size());
    const std::uint32_t slot = table.find_or_insert({block.x, block.y, 0}, fresh);
    if (slot == fresh) {
      blocks.push_back({block.x, block.y, 0});
      lowest.emplace_back().fill(kNone);
    }
    return slot;
  }
};

Tiles lowest_of(const VoxelizedScan& scan, std::vector<std::size_t>& tile_of) {
  Tiles tiles;
  for (std::size_t i = 0; i < scan.occupied.size(); ++i) {
    if (!scan.occupied[i].any()) continue;
    tile_of[i] = tiles.slot_of(scan.measured.blocks[i]);
    Tile& lowest = tiles.lowest[tile_of[i]];
    std::uint64_t columns = 0;  // those that a lower layer of the block had
    for (std::uint32_t z = 0; z < kSide; ++z) {
      const std::int32_t height = scan.measured.blocks[i].z * 8 + static_cast<std::int32_t>(z);
      std::uint64_t fresh = scan.occupied[i].words[z] & ~columns;
      columns |= fresh;
      for (; fresh != 0; fresh &= fresh - 1) {
        std::int32_t& column = lowest[static_cast<std::size_t>(std::countr_zero(fresh))];
        column = std::min(column, height);
      }
    }
  }
  return tiles;
}

/// Returns the lowest of the columns within `radius` of each column of a tile.
Tile lowest_around(const Tiles& tiles, const BlockIndex& at, int radius) {
  constexpr std::size_t kWide = 3 * kSide;
  std::array<std::array<std::int32_t, kWide>, kWide> around;
  for (std::size_t tile = 0; tile < 9; ++tile) {
    const auto tx = static_cast<int>(tile % 3), ty = static_cast<int>(tile / 3);
    const std::uint32_t slot = tiles.table.find({at.x + tx - 1, at.y + ty - 1, 0});
    for (std::size_t cell = 0; cell < kSide * kSide; ++cell) {
      around[tile / 3 * kSide + cell / kSide][tile % 3 * kSide + cell % kSide] =
          slot == kNoSlot ? kNone : tiles.lowest[slot][cell];
    }
  }
  const auto first = static_cast<std::size_t>(kBlockSide - radius);
  const auto width = static_cast<std::size_t>(2 * radius + 1);
  std::array<std::array<std::int32_t, kSide>, kWide> rows;
  for (std::size_t y = first; y + first < kWide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      const auto* begin = &around[y][first + x];
      rows[y][x] = *std::min_element(begin, begin + width);
    }
  }
  Tile lowest;
  lowest.fill(kNone);
  for (std::size_t cell = 0; cell < kSide * kSide; ++cell) {
    const std::size_t y = cell / kSide + first;
    for (std::size_t i = y; i < y + width; ++i) {
      lowest[cell] = std::min(lowest[cell], rows[i][cell % kSide]);
    }
  }
  return lowest;
}

}  // namespace

ScanMasks low_voxels(const VoxelizedScan& scan, int radius, int layers) {
  std::vector<std::size_t> tile_of(scan.occupied.size());
  const Tiles tiles = lowest_of(scan, tile_of);
  std::vector<Tile> around;
  for (const BlockIndex& block : tiles.blocks) {
    around.push_back(lowest_around(tiles, block, radius));
  }
  ScanMasks low(scan.occupied.size());
  for (std::size_t i = 0; i < low.size(); ++i) {
    if (!scan.occupied[i].any()) continue;
    const Tile& lowest = around[tile_of[i]];
    for_each_cell(scan.occupied[i], [&](std::uint32_t cell) {
      if (voxel_at(scan.measured.blocks[i], cell).z <= lowest[cell & 63] + layers) low[i].set(cell);
    });
  }
  return low;
}

}  // namespace mosbench::hmm_mos_plus
