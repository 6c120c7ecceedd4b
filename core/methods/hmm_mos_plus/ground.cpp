#include "core/methods/hmm_mos_plus/ground.hpp"

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
constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();

}  // namespace

Ground::Ground(const VoxelizedScan& scan, const Config& config)
    : radius_(config.ground_radius_voxels), layers_(config.ground_layers_voxels) {
  for (std::size_t i = 0; i < scan.occupied.size(); ++i) {
    if (!scan.occupied[i].any()) continue;
    Tile& lowest = tile_of(scan.measured.blocks[i]);
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
}

Ground::Tile& Ground::tile_of(const BlockIndex& block) {
  const auto fresh = static_cast<std::uint32_t>(lowest_.size());
  const std::uint32_t slot = table_.find_or_insert({block.x, block.y, 0}, fresh);
  if (slot == fresh) lowest_.emplace_back().fill(kNone);
  return lowest_[slot];
}

/// Returns the lowest of the columns within radius_ of each column of a block.
Ground::Tile Ground::lowest_around(const BlockIndex& at) const {
  constexpr std::size_t kWide = 3 * kSide;
  static const Tile nothing = [] {
    Tile tile;
    tile.fill(kNone);
    return tile;
  }();
  const auto first = static_cast<std::size_t>(kBlockSide - radius_);
  const auto width = static_cast<std::size_t>(2 * radius_ + 1);
  std::array<std::array<std::int32_t, kWide>, kWide> around;  // the tile in the middle of nine
  for (std::size_t tile = 0; tile < 9; ++tile) {
    const std::size_t tx = tile % 3 * kSide, ty = tile / 3 * kSide;
    const std::uint32_t slot = table_.find(
        {at.x + static_cast<int>(tile % 3) - 1, at.y + static_cast<int>(tile / 3) - 1, 0});
    const Tile& heights = slot == kNoSlot ? nothing : lowest_[slot];
    for (std::size_t y = std::max(first, ty); y < std::min(kWide - first, ty + kSide); ++y) {
      for (std::size_t x = std::max(first, tx); x < std::min(kWide - first, tx + kSide); ++x) {
        around[y][x] = heights[(y - ty) * kSide + x - tx];
      }
    }
  }
  // Loops over a row's eight columns inside: eight at a time.
  using Row = std::array<std::int32_t, kSide>;
  const auto take_lower = [](const std::int32_t* heights, std::int32_t* lowest_of_row) {
    for (std::size_t x = 0; x < kSide; ++x) {
      lowest_of_row[x] = std::min(lowest_of_row[x], heights[x]);
    }
  };
  std::array<Row, kWide> rows;
  for (std::size_t y = first; y + first < kWide; ++y) {
    rows[y].fill(kNone);
    for (std::size_t i = 0; i < width; ++i) take_lower(&around[y][first + i], rows[y].data());
  }
  Tile lowest;
  lowest.fill(kNone);
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t i = 0; i < width; ++i) {
      take_lower(rows[y + first + i].data(), &lowest[y * kSide]);
    }
  }
  return lowest;
}

BlockMask Ground::low_among(const BlockMask& voxels, const BlockIndex& block) const {
  BlockMask low;
  const Tile lowest = lowest_around(block);
  for_each_cell(voxels, [&](std::uint32_t cell) {
    if (voxel_at(block, cell).z <= lowest[cell & 63] + layers_) low.set(cell);
  });
  return low;
}

/// Returns the heights of the lowest voxels of the columns from `first` to `last`, x first.
std::vector<std::int32_t> Ground::columns(const Voxel& first, const Voxel& last) const {
  const auto width = static_cast<std::size_t>(last.x - first.x + 1);
  std::vector<std::int32_t> heights(width * static_cast<std::size_t>(last.y - first.y + 1), kNone);
  for (int ty = first.y >> 3; ty <= last.y >> 3; ++ty) {
    for (int tx = first.x >> 3; tx <= last.x >> 3; ++tx) {
      const std::uint32_t slot = table_.find({tx, ty, 0});
      if (slot == kNoSlot) continue;
      for (int y = std::max(first.y, ty * 8); y <= std::min(last.y, ty * 8 + 7); ++y) {
        const auto row = static_cast<std::size_t>(y - first.y) * width;
        for (int x = std::max(first.x, tx * 8); x <= std::min(last.x, tx * 8 + 7); ++x) {
          const auto cell = static_cast<std::size_t>((y & 7) * 8 + (x & 7));
          heights[row + static_cast<std::size_t>(x - first.x)] = lowest_[slot][cell];
        }
      }
    }
  }
  return heights;
}

std::vector<std::int32_t> Ground::lowest_within(int radius, const Voxel& first,
                                                const Voxel& last) const {
  const std::vector<std::int32_t> around =
      columns({first.x - radius, first.y - radius, 0}, {last.x + radius, last.y + radius, 0});
  const auto window = static_cast<std::size_t>(2 * radius + 1);
  const auto width = static_cast<std::size_t>(last.x - first.x + 1);
  const auto height = static_cast<std::size_t>(last.y - first.y + 1);
  const std::size_t wide = width + window - 1;
  // The lowest along y first, so that the inner loops run over whole rows.
  std::vector<std::int32_t> rows(wide * height, kNone), lowest(width * height, kNone);
  for (std::size_t i = 0; i < window; ++i) {
    for (std::size_t cell = 0; cell < rows.size(); ++cell) {
      rows[cell] = std::min(rows[cell], around[cell + i * wide]);
    }
  }
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t i = 0; i < window; ++i) {
      for (std::size_t x = 0; x < width; ++x) {
        lowest[y * width + x] = std::min(lowest[y * width + x], rows[y * wide + x + i]);
      }
    }
  }
  return lowest;
}

LowVoxels::LowVoxels(const VoxelizedScan& scan, const Ground& ground)
    : scan_(scan), ground_(ground), low_(scan.occupied.size()), found_(scan.occupied.size()) {}

const BlockMask& LowVoxels::in(std::uint32_t slot) {
  if (found_[slot] == 0) {
    found_[slot] = 1;
    low_[slot] = ground_.low_among(scan_.occupied[slot], scan_.measured.blocks[slot]);
  }
  return low_[slot];
}

}  // namespace mosbench::hmm_mos_plus
