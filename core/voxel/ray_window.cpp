#include "core/voxel/ray_window.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "core/base/thread_pool.hpp"

namespace mosbench {
namespace {

constexpr std::uint32_t kBlocksPerTile = 64;

/// Tiles that any of the windows touched, in rising order.
std::vector<std::uint32_t> touched_tiles(const std::vector<std::uint8_t>& touched) {
  std::vector<std::uint32_t> tiles;
  for (std::size_t tile = 0; tile < touched.size(); ++tile) {
    if (touched[tile] != 0) tiles.push_back(static_cast<std::uint32_t>(tile));
  }
  return tiles;
}

/// Swaps the axes of eight rows of eight bits (Warren, Hacker's Delight, 7-3).
std::uint64_t turned(std::uint64_t rows) {
  const auto swap = [&rows](int distance, std::uint64_t lower) {
    const std::uint64_t differ = (rows ^ rows >> distance) & lower;
    rows ^= differ ^ differ << distance;
  };
  swap(7, 0x00AA00AA00AA00AAu);
  swap(14, 0x0000CCCC0000CCCCu);
  swap(28, 0x00000000F0F0F0F0u);
  return rows;
}

BlockMask turned(const BlockMask& mask) {
  BlockMask result;
  for (std::size_t z = 0; z < kBlockSide; ++z) result.words[z] = turned(mask.words[z]);
  return result;
}

BlockMask read(const std::uint8_t* bytes) {
  BlockMask mask;
  std::memcpy(mask.words.data(), bytes, sizeof(mask.words));
  return mask;
}

void append(const VoxelList& part, VoxelList& all) {
  all.blocks.insert(all.blocks.end(), part.blocks.begin(), part.blocks.end());
  all.masks.insert(all.masks.end(), part.masks.begin(), part.masks.end());
}

}  // namespace

void RayWindow::lay_out(const std::array<int, 3>& log2_tiles, BytesAlong axis) {
  log2_tiles_ = log2_tiles;
  bytes_along_ = axis;
  tiles_.x_tiles_ = (1u << log2_tiles[0]) - 1;
  tiles_.y_tiles_ = ((1u << log2_tiles[1]) - 1) << log2_tiles[0];
  const std::size_t tiles = std::size_t{1} << (log2_tiles[0] + log2_tiles[1] + log2_tiles[2]);
  if (tiles > capacity_tiles_) {
    bits_.reset();
    capacity_tiles_ = 0;
    resident_.assign(tiles, 0);
    // calloc, not vector: pages of large windows that no ray touches stay unmapped.
    bits_.reset(static_cast<std::uint8_t*>(std::calloc(tiles, kTileBytes)));
    if (!bits_) throw std::bad_alloc();
    capacity_tiles_ = tiles;
  }
  touched_.assign(tiles, 0);
  tiles_.touched_ = touched_.data();
}

void RayWindow::copy_turned(const RayWindow& other) {
  for (const std::uint32_t tile : touched_tiles(other.touched_)) {
    touched_[tile] = 1;
    for (std::uint32_t block = 0; block < kBlocksPerTile; ++block) {
      const std::size_t at = std::size_t{tile} * kTileBytes + block * sizeof(BlockMask);
      const BlockMask mask = read(other.bits() + at);
      if (mask.any()) std::memcpy(bits() + at, turned(mask).words.data(), sizeof(mask.words));
    }
  }
}

/// Returns a block's bits and clears them in the window.
BlockMask RayWindow::take(std::size_t byte) {
  const BlockMask mask = read(bits() + byte);
  if (!mask.any()) return mask;
  std::memset(bits() + byte, 0, sizeof(mask.words));
  return bytes_along_ == BytesAlong::kX ? mask : turned(mask);
}

std::size_t RayWindow::memory_bytes() const {
  const auto resident = std::count(resident_.begin(), resident_.end(), std::uint8_t{1});
  return static_cast<std::size_t>(resident) * kTileBytes + 2 * capacity_tiles_;
}

BlockIndex RayWindow::block_at(std::uint32_t tile, std::uint32_t block,
                               const BlockIndex& first) const {
  const auto at = [](std::uint32_t tiles, std::uint32_t blocks) {
    return static_cast<std::int32_t>(tiles * 4 + blocks % 4);
  };
  return {first.x + at(tile & tiles_.x_tiles_, block / 16),
          first.y + at((tile & tiles_.y_tiles_) >> log2_tiles_[0], block / 4),
          first.z + at(tile >> (log2_tiles_[0] + log2_tiles_[1]), block)};
}

VoxelList collect(std::span<RayWindow> windows, const BlockIndex& first_block, ThreadPool& pool) {
  RayWindow& all = windows.front();
  for (const RayWindow& window : windows.subspan(1)) {
    std::ranges::transform(all.touched_, window.touched_, all.touched_.begin(), std::bit_or<>{});
  }
  const std::vector<std::uint32_t> tiles = touched_tiles(all.touched_);
  constexpr std::size_t kGrain = 32;
  std::vector<VoxelList> parts((tiles.size() + kGrain - 1) / kGrain);
  pool.for_ranges(tiles.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned) {
    VoxelList& part = parts[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint32_t block = 0; block < kBlocksPerTile; ++block) {
        const std::size_t at =
            std::size_t{tiles[i]} * RayWindow::kTileBytes + block * sizeof(BlockMask);
        BlockMask mask = all.take(at);
        for (RayWindow& window : windows.subspan(1)) {
          if (window.touched_[tiles[i]] != 0) mask = mask | window.take(at);
        }
        if (!mask.any()) continue;
        part.blocks.push_back(all.block_at(tiles[i], block, first_block));
        part.masks.push_back(mask);
      }
    }
  });
  VoxelList observed;
  for (const VoxelList& part : parts) append(part, observed);
  for (RayWindow& window : windows) {
    for (const std::uint32_t tile : tiles) window.resident_[tile] |= window.touched_[tile];
  }
  return observed;
}

}  // namespace mosbench
