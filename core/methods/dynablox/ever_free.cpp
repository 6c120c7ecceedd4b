#include "core/methods/dynablox/ever_free.hpp"

#include <algorithm>
#include <limits>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"
#include "core/voxel/neighbourhood.hpp"

namespace mosbench::dynablox {
namespace {

struct Frame {
  std::int32_t now;
  std::int32_t buffer_start;  ///< runs go on when last occupied at or after this
  std::int32_t recent_start;  ///< occupied in the burn-in when last occupied at or after this
  std::int32_t counter_to_reset;
};

/// The bits of a plane of eight rows, one byte each.
struct HistoryBits {
  std::uint64_t recent, worn;
};

/// One row of eight voxels; `occupied` are those occupied in this frame.
inline __attribute__((always_inline)) void count_row(VoxelHistory& voxels, std::size_t row,
                                                     std::uint32_t occupied, const Frame& frame,
                                                     HistoryBits& plane) {
  auto last = load<IntLanes>(&voxels.last_occupied[row * kLanes]);
  if (occupied != 0) {
    const IntLanes is_occupied = lanes_of(occupied);
    using Runs = std::uint16_t __attribute__((vector_size(16)));
    const auto run = __builtin_convertvector(load<Runs>(&voxels.runs[row * kLanes]), IntLanes);
    constexpr std::int32_t kMost = std::numeric_limits<std::uint16_t>::max();
    const IntLanes longer = run < kMost ? run + 1 : run;
    const IntLanes counted = last >= frame.buffer_start ? longer : IntLanes{} + 1;
    const IntLanes new_run = is_occupied ? counted : run;
    last = is_occupied ? IntLanes{} + frame.now : last;
    store(__builtin_convertvector(new_run, Runs), &voxels.runs[row * kLanes]);
    store(last, &voxels.last_occupied[row * kLanes]);
    plane.worn = with_row(plane.worn, row & 7, bits_of(new_run >= frame.counter_to_reset));
  }
  plane.recent = with_row(plane.recent, row & 7, bits_of(last >= frame.recent_start));
}

/// The first half of the update, for the voxels of one block.
MOSBENCH_MULTIARCH void count_occupied(BlockHistory& history, VoxelHistory& voxels,
                                       const BlockMask& occupied_voxels, const Frame& frame) {
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    const std::uint64_t occupied = occupied_voxels.words[z];
    HistoryBits plane{history.recent.words[z], history.worn.words[z]};
    const std::uint64_t concerned = occupied | plane.recent;
    if (concerned == 0) continue;
    for (std::size_t y = 0; y < kBlockSide; ++y) {
      if ((concerned >> (8 * y) & 0xFF) == 0) continue;
      count_row(voxels, z * kBlockSide + y, static_cast<std::uint32_t>(occupied >> (8 * y) & 0xFF),
                frame, plane);
    }
    history.recent.words[z] = plane.recent;
    history.worn.words[z] = plane.worn;
  }
  history.recent_frame = frame.now;
}

/// The same for a block whose voxels were never observed: all are near a surface, d = 0.
void count_unobserved(BlockHistory& history, const Frame& frame) {
  constexpr std::uint16_t kMost = std::numeric_limits<std::uint16_t>::max();
  const bool goes_on = history.last_occupied >= frame.buffer_start;
  history.run = goes_on ? static_cast<std::uint16_t>(std::min(history.run + 1, int{kMost}))
                        : std::uint16_t{1};
  history.last_occupied = frame.now;
}

/// Returns the voxels that cannot border on ever-free space: unobserved, or occupied in the
/// burn-in.
BlockMask barred(const EverFreeMap& map, std::uint32_t slot, const Frame& frame) {
  const BlockMask unobserved = ~map.tsdf.blocks[slot].observed;
  const BlockHistory& history = map.histories[slot];
  if (history.recent_frame == frame.now || !history.recent.any()) {
    return unobserved | history.recent;
  }
  BlockMask recent;
  const VoxelHistory& voxels = map.voxels[history.voxels];
  for_each_cell(history.recent, [&](std::uint32_t cell) {
    if (voxels.last_occupied[cell] >= frame.recent_start) recent.set(cell);
  });
  return unobserved | recent;
}

/// The second half of the update, for one block.
void make_ever_free(EverFreeMap& map, std::uint32_t slot, const Frame& frame) {
  BlockHistory& history = map.histories[slot];
  if (history.voxels == kNoSlot) return;
  // Most voxels that are not ever-free have an occupied or unobserved one beside them in their
  // block.
  const BlockMask candidates =
      without(~history.ever_free, grown_inside(~map.tsdf.blocks[slot].observed | history.recent));
  if (!candidates.any()) return;
  static constexpr BlockMask kAll{{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull}};
  std::array<BlockMask, 27> masks;
  Neighbourhood around{};
  const BlockIndex& centre = map.tsdf.blocks.index_of(slot);
  for_each_neighbour(centre, [&](std::size_t position, const BlockIndex& index) {
    const std::uint32_t neighbour = position == 13 ? slot : map.tsdf.blocks.find(index);
    around[position] = &kAll;
    if (neighbour == kNoSlot || map.histories[neighbour].voxels == kNoSlot) return;
    masks[position] = barred(map, neighbour, frame);
    around[position] = &masks[position];
  });
  HaloRows halo;
  gather_halo(around, 1, halo);
  history.ever_free = history.ever_free | without(candidates, dilate(halo));
}

void clear_ever_free(EverFreeMap& map, const Voxel& voxel) {
  const std::uint32_t slot = map.tsdf.blocks.find(block_of(voxel));
  if (slot == kNoSlot) return;
  BlockMask cleared;
  cleared.set(cell_of(voxel));
  map.histories[slot].ever_free = without(map.histories[slot].ever_free, cleared);
}

/// Calls visit(voxel) for the 26 neighbours.
template <typename Visit>
void for_each_around(const Voxel& voxel, Visit&& visit) {
  for (int i = 0; i < 27; ++i) {
    if (i != 13) visit(Voxel{voxel.x + i % 3 - 1, voxel.y + i / 3 % 3 - 1, voxel.z + i / 9 - 1});
  }
}

/// Clears worn voxels and those around them, in one wide block after the other, voxels in the order
/// z, y, x: one that an earlier one cleared clears none itself. Other wide blocks are changed at
/// the end, so that the order of wide blocks does not matter.
void clear_worn(EverFreeMap& map, std::span<const std::uint32_t> worn_slots) {
  struct WornVoxel {
    BlockIndex wide;
    Voxel voxel;
  };
  std::vector<WornVoxel> worn;
  for (const std::uint32_t slot : worn_slots) {
    const BlockIndex index = map.tsdf.blocks.index_of(slot);
    const BlockHistory& history = map.histories[slot];
    for_each_cell(history.worn & history.ever_free, [&](std::uint32_t cell) {
      worn.push_back({{index.x >> 1, index.y >> 1, index.z >> 1}, voxel_at(index, cell)});
    });
  }
  const auto key = [](const WornVoxel& w) {
    return std::array{w.wide.z, w.wide.y, w.wide.x, w.voxel.z, w.voxel.y, w.voxel.x};
  };
  std::ranges::sort(worn, {}, key);
  std::vector<Voxel> in_other_blocks;
  for (const WornVoxel& one : worn) {
    if (!map.ever_free_in(block_of(one.voxel)).test(cell_of(one.voxel))) continue;
    clear_ever_free(map, one.voxel);
    for_each_around(one.voxel, [&](const Voxel& neighbour) {
      const BlockIndex index = block_of(neighbour);
      if (BlockIndex{index.x >> 1, index.y >> 1, index.z >> 1} == one.wide) {
        clear_ever_free(map, neighbour);
      } else {
        in_other_blocks.push_back(neighbour);
      }
    });
  }
  for (const Voxel& voxel : in_other_blocks) clear_ever_free(map, voxel);
}

}  // namespace

void EverFreeMap::touch(const std::vector<BlockIndex>& wide_blocks, std::int32_t last_occupied) {
  tsdf::TsdfMap::Touched blocks = tsdf.touch(wide_blocks);
  histories.resize(tsdf.blocks.slot_count());
  for (const std::uint32_t slot : blocks.fresh) {
    histories[slot] = BlockHistory{};
    histories[slot].last_occupied = last_occupied;
  }
  touched = std::move(blocks.slots);
}

void EverFreeMap::add_voxels(int counter_to_reset) {
  for (const std::uint32_t slot : touched) {
    BlockHistory& history = histories[slot];
    if (history.voxels != kNoSlot || tsdf.blocks[slot].numbers == kNoSlot) continue;
    history.voxels = voxels.take();
    VoxelHistory& all = voxels[history.voxels];
    all.last_occupied.fill(history.last_occupied);
    all.runs.fill(history.run);
    history.worn = history.run >= counter_to_reset ? ~BlockMask{} : BlockMask{};
    history.recent = ~BlockMask{};  // may be: of no frame yet
    history.recent_frame = -1;
  }
}

void EverFreeMap::keep_near(const Eigen::Vector3d& sensor_m, const VoxelGrid& grid,
                            const tsdf::Config& config) {
  for (const std::uint32_t slot : tsdf.keep_near(sensor_m, grid, config)) {
    if (histories[slot].voxels != kNoSlot) voxels.give_back(histories[slot].voxels);
  }
}

std::size_t EverFreeMap::memory_bytes() const {
  return tsdf.memory_bytes() + voxels.memory_bytes() + histories.capacity() * sizeof(BlockHistory) +
         touched.capacity() * sizeof(std::uint32_t);
}

void update_ever_free(EverFreeMap& map, const VoxelSet& measured, std::int32_t frame_number,
                      const Config& config, ThreadPool& pool) {
  const Frame frame{frame_number, frame_number - config.temporal_buffer_scans,
                    frame_number - config.burn_in_scans + 1, config.counter_to_reset_scans};
  std::vector<std::uint8_t> is_worn(map.touched.size());
  pool.for_ranges(map.touched.size(), 32, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t slot = map.touched[i];
      BlockHistory& history = map.histories[slot];
      if (history.voxels == kNoSlot) {
        count_unobserved(history, frame);
        continue;
      }
      const BlockMask* points = measured.mask_of(map.tsdf.blocks.index_of(slot));
      const BlockMask& near_surface = map.tsdf.blocks[slot].near_surface;
      count_occupied(history, map.voxels[history.voxels],
                     points ? near_surface | *points : near_surface, frame);
      is_worn[i] = (history.worn & history.ever_free).any();
    }
  });
  std::vector<std::uint32_t> worn_slots;
  for (std::size_t i = 0; i < is_worn.size(); ++i) {
    if (is_worn[i] != 0) worn_slots.push_back(map.touched[i]);
  }
  if (!worn_slots.empty()) clear_worn(map, worn_slots);
  pool.for_ranges(map.touched.size(), 32, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) make_ever_free(map, map.touched[i], frame);
  });
}

}  // namespace mosbench::dynablox
