#include "core/dynablox/tsdf_map.hpp"

#include "core/dynablox/ray_blocks.hpp"

namespace mosbench::dynablox {

std::vector<std::uint32_t> TsdfMap::touch(const std::vector<BlockIndex>& wide_blocks,
                                          std::int32_t last_occupied) {
  std::vector<std::uint32_t> slots;
  slots.reserve(wide_blocks.size() * 8);
  for (const BlockIndex& wide : wide_blocks) {
    const BlockIndex first = first_in(wide);
    for (int part = 0; part < 8; ++part) {
      const auto [slot, fresh] = blocks.find_or_add(
          {first.x + (part & 1), first.y + (part >> 1 & 1), first.z + (part >> 2)});
      if (fresh) {
        blocks[slot] = MapBlock{};
        blocks[slot].near_surface = ~BlockMask{};
        blocks[slot].last_occupied = last_occupied;
      }
      slots.push_back(slot);
    }
  }
  return slots;
}

void TsdfMap::add_numbers(MapBlock& block, int counter_to_reset) {
  block.numbers = numbers.take();
  VoxelNumbers& all = numbers[block.numbers];
  all.distances_m.fill(0);
  all.weights.fill(0);
  all.last_occupied.fill(block.last_occupied);
  all.runs.fill(block.run);
  block.worn = block.run >= counter_to_reset ? ~BlockMask{} : BlockMask{};
  block.recent = ~BlockMask{};  // may be: of no frame yet
  block.recent_frame = -1;
}

void TsdfMap::keep_within(double radius_m, const VoxelGrid& grid, const Eigen::Vector3d& sensor_m) {
  blocks.for_each_slot([&](std::uint32_t slot) {
    const BlockIndex wide = wide_of(blocks.index_of(slot));
    const Eigen::Vector3d centre_m =
        grid.corner_m({wide.x * kWideSide + kWideSide / 2, wide.y * kWideSide + kWideSide / 2,
                       wide.z * kWideSide + kWideSide / 2});
    if ((centre_m - sensor_m).squaredNorm() <= radius_m * radius_m) return;
    if (blocks[slot].numbers != kNoSlot) numbers.give_back(blocks[slot].numbers);
    blocks.erase(slot);
  });
}

std::size_t TsdfMap::memory_bytes() const {
  return blocks.memory_bytes() + numbers.memory_bytes() +
         touched.capacity() * sizeof(std::uint32_t);
}

}  // namespace mosbench::dynablox
