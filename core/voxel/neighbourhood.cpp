#include "core/voxel/neighbourhood.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench {
namespace {

using Bytes = std::array<std::uint8_t, kBlockSide>;

inline __attribute__((always_inline)) Bytes rows_of(const BlockMask* mask, int z) {
  Bytes bytes{};
  if (mask != nullptr) std::memcpy(bytes.data(), &mask->words[static_cast<std::size_t>(z)], 8);
  return bytes;
}

std::uint32_t row_mask(const HaloRows& halo) { return ~std::uint32_t{0} >> (32 - halo.side); }

/// Of three blocks in a row, bit 1 the middle one, those within `radius` of the set bits of a byte.
std::uint32_t reached_along_axis(std::uint32_t byte, int radius) {
  const std::uint32_t low = (1u << radius) - 1, high = 0xFFu & ~(0xFFu >> radius);
  return ((byte & low) != 0 ? 1u : 0u) | 2u | ((byte & high) != 0 ? 4u : 0u);
}

/// Slots of a scan's blocks without repeats, in the order in which they were first added.
class SlotList {
 public:
  explicit SlotList(const VoxelizedScan& scan) : scan_(scan), taken_(scan.measured.block_count()) {}

  /// Adds those of a block and its 26 neighbours whose bit is set.
  void add(const BlockIndex& centre, std::uint32_t neighbours) {
    for (; neighbours != 0; neighbours &= neighbours - 1) {
      const int position = std::countr_zero(neighbours);
      const std::uint32_t slot =
          scan_.measured.find({centre.x + position % 3 - 1, centre.y + position / 3 % 3 - 1,
                               centre.z + position / 9 - 1});
      if (slot == kNoSlot || taken_[slot] != 0) continue;
      taken_[slot] = 1;
      slots_.push_back(slot);
    }
  }
  std::vector<std::uint32_t> take() { return std::move(slots_); }

 private:
  const VoxelizedScan& scan_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> slots_;
};

constexpr std::uint32_t kWholeNeighbourhood = (1u << 27) - 1;

}  // namespace

std::uint32_t blocks_within(const BlockMask& mask, int radius) {
  std::uint64_t plane = 0;
  std::uint32_t x = 0, y = 0, z = 0;
  for (std::uint32_t i = 0; i < kBlockSide; ++i) {
    plane |= mask.words[i];
    z |= static_cast<std::uint32_t>(mask.words[i] != 0) << i;
  }
  if (plane == 0) return 0;
  for (std::uint32_t i = 0; i < kBlockSide; ++i) {
    const auto row = static_cast<std::uint32_t>(plane >> (8 * i) & 0xFFu);
    x |= row;
    y |= static_cast<std::uint32_t>(row != 0) << i;
  }
  const std::uint32_t along_x = reached_along_axis(x, radius),
                      along_y = reached_along_axis(y, radius),
                      along_z = reached_along_axis(z, radius);
  std::uint32_t reached = 0;
  for (std::uint32_t block = 0; block < 27; ++block) {
    const std::uint32_t all =
        along_x >> (block % 3) & along_y >> (block / 3 % 3) & along_z >> (block / 9);
    reached |= (all & 1u) << block;
  }
  return reached;
}

MOSBENCH_MULTIARCH void gather_halo(const Neighbourhood& masks, int radius, HaloRows& halo) {
  halo.radius = radius;
  halo.side = kBlockSide + 2 * radius;
  const std::uint32_t kept = row_mask(halo);
  std::uint32_t any = 0;
  for (int z = 0; z < halo.side; ++z) {
    const int map_z = z - radius;
    for (int block_y = 0; block_y < 3; ++block_y) {
      const BlockMask* const* blocks =
          &masks[static_cast<std::size_t>(((map_z >> 3) + 1) * 9 + block_y * 3)];
      std::uint32_t* rows =
          &halo.rows[static_cast<std::size_t>(z * HaloRows::kStride + block_y * kBlockSide)];
      const Bytes low = rows_of(blocks[0], map_z & 7), middle = rows_of(blocks[1], map_z & 7),
                  high = rows_of(blocks[2], map_z & 7);
      for (std::size_t y = 0; y < kBlockSide; ++y) {
        const std::uint32_t wide =
            std::uint32_t{low[y]} | std::uint32_t{middle[y]} << 8 | std::uint32_t{high[y]} << 16;
        rows[y] = wide >> (kBlockSide - radius) & kept;
      }
    }
    for (int y = 0; y < halo.side; ++y) any |= halo.row(z, y);
  }
  halo.any = any != 0;
}

MOSBENCH_MULTIARCH void close_columns(const HaloRows& halo, int gap, HaloRows& closed) {
  constexpr std::size_t kStride = HaloRows::kStride;
  using Plane = std::array<std::uint32_t, kStride>;
  closed.radius = halo.radius - gap;
  closed.side = halo.side - 2 * gap;
  const std::uint32_t kept = row_mask(closed);
  std::uint32_t any = 0;
  std::array<Plane, kMaxHalo + 1> below;  // [i]: those at most i below
  below[0].fill(0);
  for (int z = 0; z < closed.side; ++z) {
    const auto plane = [&](int dz) {
      return &halo.rows[static_cast<std::size_t>(z + gap + dz) * kStride];
    };
    std::uint32_t* const rows = &closed.rows[static_cast<std::size_t>(z) * kStride];
    std::copy_n(plane(0), kStride, rows);
    for (int i = 1; i <= gap; ++i) {
      const auto at = static_cast<std::size_t>(i);
      for (std::size_t y = 0; y < kStride; ++y) below[at][y] = below[at - 1][y] | plane(-i)[y];
    }
    for (int i = 1; i <= gap; ++i) {
      const Plane& near = below[static_cast<std::size_t>(gap + 1 - i)];
      for (std::size_t y = 0; y < kStride; ++y) rows[y] |= plane(i)[y] & near[y];
    }
    for (std::size_t y = 0; y < kStride; ++y) rows[y] = rows[y] >> gap & kept;
    for (int y = 0; y < closed.side; ++y) any |= closed.row(z, y);
  }
  closed.any = any != 0;
}

MOSBENCH_MULTIARCH void invert(HaloRows& halo) {
  const std::uint32_t kept = row_mask(halo);
  std::uint32_t any = 0;
  for (int z = 0; z < halo.side; ++z) {
    for (int y = 0; y < halo.side; ++y) {
      std::uint32_t& row =
          halo.rows[static_cast<std::size_t>(z * HaloRows::kStride + kBlockSide - halo.radius + y)];
      row = ~row & kept;
      any |= row;
    }
  }
  halo.any = any != 0;
}

MOSBENCH_MULTIARCH BlockMask dilate(const HaloRows& halo) {
  BlockMask result;
  if (!halo.any) return result;
  const int width = 2 * halo.radius + 1;
  alignas(32) std::array<std::uint32_t, HaloRows::kStride> spread;
  for (int z = 0; z < halo.side; ++z) {
    const std::uint32_t* rows = &halo.rows[static_cast<std::size_t>(z * HaloRows::kStride)];
    for (std::size_t y = 0; y < spread.size(); y += kLanes) {
      const auto row = load<UintLanes>(rows + y);
      UintLanes bits = row;
      for (int i = 1; i < width; ++i) bits |= row >> i;
      store(bits, &spread[y]);
    }
    UintLanes united{};
    for (int i = 0; i < width; ++i) united |= load<UintLanes>(&spread[kLanes] + i - halo.radius);
    const auto bytes = __builtin_convertvector(united, ByteLanes);
    const auto plane = std::bit_cast<std::uint64_t>(bytes);
    for (int out = std::max(0, z - width + 1); out <= std::min(kBlockSide - 1, z); ++out) {
      result.words[static_cast<std::size_t>(out)] |= plane;
    }
  }
  return result;
}

BlockMask grown_inside(const BlockMask& mask) {
  BlockMask planes;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    const std::uint64_t word = mask.words[z];
    const std::uint64_t row = word | beside_in_row(word);
    planes.words[z] = row | row << 8 | row >> 8;
  }
  BlockMask grown = planes;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    if (z > 0) grown.words[z] |= planes.words[z - 1];
    if (z + 1 < kBlockSide) grown.words[z] |= planes.words[z + 1];
  }
  return grown;
}

MOSBENCH_MULTIARCH int count_around(const HaloRows& halo, std::uint32_t cell) {
  const int x = static_cast<int>(cell & 7), y = static_cast<int>((cell >> 3) & 7),
            z = static_cast<int>(cell >> 6);
  const int width = 2 * halo.radius + 1;
  const std::uint32_t kept = (std::uint32_t{1} << width) - 1;
  int count = 0;
  for (int dz = 0; dz < width; ++dz) {
    for (int dy = 0; dy < width; ++dy) {
      count += std::popcount((halo.row(z + dz, y + dy) >> x) & kept);
    }
  }
  return count;
}

std::vector<std::uint32_t> slots_around(const VoxelizedScan& scan,
                                        std::span<const BlockIndex> blocks) {
  SlotList slots(scan);
  for (const BlockIndex& block : blocks) slots.add(block, kWholeNeighbourhood);
  return slots.take();
}

std::vector<std::uint32_t> slots_within(const VoxelizedScan& scan, const VoxelSet& seeds,
                                        int radius) {
  SlotList slots(scan);
  for (std::size_t i = 0; i < seeds.block_count(); ++i) {
    slots.add(seeds.blocks[i], blocks_within(seeds.masks[i], radius));
  }
  return slots.take();
}

std::vector<BlockIndex> blocks_of(const VoxelizedScan& scan, std::span<const std::uint32_t> slots) {
  std::vector<BlockIndex> blocks;
  for (const std::uint32_t slot : slots) blocks.push_back(scan.measured.blocks[slot]);
  return blocks;
}

void gather_around(const VoxelSet& voxels, const BlockIndex& block, int radius, HaloRows& rows) {
  Neighbourhood masks{};
  for_each_neighbour(block, [&](std::size_t position, const BlockIndex& neighbour) {
    masks[position] = voxels.mask_of(neighbour);
  });
  gather_halo(masks, radius, rows);
}

VoxelSet set_of(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                std::span<const BlockMask> masks) {
  VoxelSet set;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (masks[i].any()) set.masks[set.insert(scan.measured.blocks[slots[i]])] = masks[i];
  }
  return set;
}

}  // namespace mosbench
