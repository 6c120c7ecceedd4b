#include "core/voxel/neighbourhood.hpp"

#include <bit>
#include <utility>

namespace mosbench {
namespace {

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
