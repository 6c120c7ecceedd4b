#include "core/hmm_mos/convolution.hpp"

#include <array>
#include <bit>
#include <utility>

#include "core/voxel/halo.hpp"

namespace mosbench::hmm_mos {
namespace {

/// Map slots of the 27 blocks around each scan block, refreshed; 27 entries per scan block.
std::vector<std::uint32_t> refreshed_map_slots(const VoxelizedScan& scan,
                                               std::span<const std::uint32_t> slots, VoxelMap& map,
                                               std::uint32_t scan_index, ThreadPool& pool) {
  std::vector<std::uint32_t> around(slots.size() * 27);
  pool.for_ranges(slots.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      for_each_neighbour(scan.measured.blocks[slots[i]],
                         [&](std::size_t position, const BlockIndex& block) {
                           around[i * 27 + position] = map.find(block);
                         });
    }
  });
  std::vector<std::uint32_t> asked;
  std::vector<std::uint8_t> taken(map.slot_count());
  for (const std::uint32_t slot : around) {
    if (slot == kNoSlot || taken[slot] != 0) continue;
    taken[slot] = 1;
    asked.push_back(slot);
  }
  map.refresh(asked, scan_index, pool);
  return around;
}

/// Known voxels around a block.
void gather_known(const VoxelMap& map, std::span<const std::uint32_t> map_slots, int radius,
                  HaloRows& halo) {
  std::array<BlockMask, 27> known;
  Neighbourhood masks{};
  for (std::size_t i = 0; i < 27; ++i) {
    if (map_slots[i] == kNoSlot) continue;
    known[i] = map.known(map_slots[i]);
    masks[i] = &known[i];
  }
  gather_halo(masks, radius, halo);
}

/// Slots of a scan's blocks without repeats, in the order they were first added.
class SlotList {
 public:
  explicit SlotList(const VoxelizedScan& scan) : scan_(scan), taken_(scan.measured.block_count()) {}

  /// Those of a block and its 26 neighbours whose bit is set.
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

std::vector<std::uint32_t> slots_within(const VoxelizedScan& scan, const VoxelSet& voxels,
                                        int radius) {
  SlotList slots(scan);
  for (std::size_t i = 0; i < voxels.block_count(); ++i) {
    slots.add(voxels.blocks[i], blocks_within(voxels.masks[i], radius));
  }
  return slots.take();
}

ScoreField convolve(const VoxelizedScan& scan, const VoxelSet& changed, int kernel_width_voxels,
                    VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool) {
  const int radius = (kernel_width_voxels - 1) / 2;
  const int volume = kernel_width_voxels * kernel_width_voxels * kernel_width_voxels;
  VoxelSet hits;  // occupied voxels that changed
  for (std::size_t i = 0; i < changed.block_count(); ++i) {
    const BlockMask* occupied = scan.occupied_in(changed.blocks[i]);
    if (occupied == nullptr) continue;
    const BlockMask both = *occupied & changed.masks[i];
    if (both.any()) hits.masks[hits.insert(changed.blocks[i])] = both;
  }
  const std::vector<std::uint32_t> slots = slots_within(scan, hits, radius);
  const std::vector<std::uint32_t> map_slots =
      refreshed_map_slots(scan, slots, map, scan_index, pool);
  // With a delay of w_g scans or more a voxel may be forgotten since it changed.
  for (std::size_t i = 0; i < hits.block_count(); ++i) {
    const std::uint32_t slot = map.find(hits.blocks[i]);
    hits.masks[i] = slot == kNoSlot ? BlockMask{} : hits.masks[i] & map.known(slot);
  }

  std::vector<ScoreField::Block> scores(slots.size());
  std::vector<std::uint8_t> scored(slots.size());
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows hit_rows, known_rows;
    for (std::size_t i = begin; i < end; ++i) {
      Neighbourhood masks{};
      for_each_neighbour(scan.measured.blocks[slots[i]],
                         [&](std::size_t position, const BlockIndex& block) {
                           masks[position] = hits.mask_of(block);
                         });
      gather_halo(masks, radius, hit_rows);
      const BlockMask in_reach = dilate(hit_rows) & scan.occupied[slots[i]];
      scores[i].fill(0);
      if (!in_reach.any()) continue;
      gather_known(map, std::span(map_slots).subspan(i * 27, 27), radius, known_rows);
      for_each_cell(in_reach, [&](std::uint32_t cell) {
        const int unknown = volume - count_around(known_rows, cell);
        const int score = count_around(hit_rows, cell) - unknown;
        if (score <= 0) return;
        scores[i][cell] = static_cast<std::int16_t>(score);
        scored[i] = 1;
      });
    }
  });

  ScoreField field;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (scored[i] != 0) field.add(scan.measured.blocks[slots[i]], scores[i]);
  }
  return field;
}

VoxelSet beside_unknown(const VoxelizedScan& scan, std::span<const BlockIndex> blocks,
                        std::span<const BlockIndex> more_blocks, int kernel_width_voxels,
                        VoxelMap& map, std::uint32_t scan_index, ThreadPool& pool) {
  std::vector<BlockIndex> asked(blocks.begin(), blocks.end());
  asked.insert(asked.end(), more_blocks.begin(), more_blocks.end());
  const std::vector<std::uint32_t> slots = slots_around(scan, asked);
  const std::vector<std::uint32_t> map_slots =
      refreshed_map_slots(scan, slots, map, scan_index, pool);
  std::vector<BlockMask> masks(slots.size());
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows;
    for (std::size_t i = begin; i < end; ++i) {
      gather_known(map, std::span(map_slots).subspan(i * 27, 27), (kernel_width_voxels - 1) / 2,
                   rows);
      invert(rows);
      masks[i] = dilate(rows) & scan.occupied[slots[i]];
    }
  });
  VoxelSet beside;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (!masks[i].any()) continue;
    beside.masks[beside.insert(scan.measured.blocks[slots[i]])] = masks[i];
  }
  return beside;
}

}  // namespace mosbench::hmm_mos
