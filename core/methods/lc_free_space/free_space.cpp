#include "core/methods/lc_free_space/free_space.hpp"

#include <cstddef>
#include <cstdint>

namespace mosbench::lc_free_space {
namespace {

/// Returns the voxels of a block that share a face with one of its own in the mask.
BlockMask beside(const BlockMask& mask) {
  BlockMask result;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    const std::uint64_t word = mask.words[z];
    result.words[z] = beside_in_row(word) | word << 8 | word >> 8;
    if (z > 0) result.words[z] |= mask.words[z - 1];
    if (z + 1 < kBlockSide) result.words[z] |= mask.words[z + 1];
  }
  return result;
}

/// The masks of the six blocks around one; those that are absent are empty.
struct Sides {
  BlockMask left, right, front, back, below, above;
};

/// Returns the voxels of a block that share a face with one of the masks around it.
BlockMask beside(const Sides& sides) {
  BlockMask result;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    result.words[z] = (sides.left.words[z] & kLastColumn) >> 7 |
                      (sides.right.words[z] & kFirstColumn) << 7 | sides.front.words[z] >> 56 |
                      sides.back.words[z] << 56;
  }
  result.words.front() |= sides.below.words.back();
  result.words.back() |= sides.above.words.front();
  return result;
}

}  // namespace

std::vector<BlockMask> in_free_space(const VoxelSet& measured, const tsdf::TsdfMap& map) {
  std::vector<BlockMask> result(measured.block_count());
  for (std::size_t slot = 0; slot < result.size(); ++slot) {
    const tsdf::MapBlock* block = map.find(measured.blocks[slot]);
    if (block == nullptr) continue;
    result[slot] = measured.masks[slot] & without(block->observed, block->near_surface);
  }
  return result;
}

std::vector<BlockMask> grown(const VoxelSet& measured, std::span<const BlockMask> seeds) {
  std::vector<BlockMask> result(seeds.size());
  for (std::size_t slot = 0; slot < seeds.size(); ++slot) {
    const BlockIndex& at = measured.blocks[slot];
    const auto seeds_at = [&](int x, int y, int z) {
      const std::uint32_t other = measured.find({at.x + x, at.y + y, at.z + z});
      return other == kNoSlot ? BlockMask{} : seeds[other];
    };
    const Sides sides{.left = seeds_at(-1, 0, 0),
                      .right = seeds_at(1, 0, 0),
                      .front = seeds_at(0, -1, 0),
                      .back = seeds_at(0, 1, 0),
                      .below = seeds_at(0, 0, -1),
                      .above = seeds_at(0, 0, 1)};
    const BlockMask around = beside(seeds[slot]) | beside(sides);
    result[slot] = seeds[slot] | (around & measured.masks[slot]);
  }
  return result;
}

}  // namespace mosbench::lc_free_space
