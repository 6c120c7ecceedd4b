#include "core/tsdf/tsdf_map.hpp"

#include "core/tsdf/ray_blocks.hpp"

namespace mosbench::tsdf {

TsdfMap::Touched TsdfMap::touch(const std::vector<BlockIndex>& wide_blocks) {
  Touched touched;
  touched.slots.reserve(wide_blocks.size() * 8);
  for (const BlockIndex& wide : wide_blocks) {
    const BlockIndex first = first_in(wide);
    for (int part = 0; part < 8; ++part) {
      const auto [slot, fresh] = blocks.find_or_add(
          {first.x + (part & 1), first.y + (part >> 1 & 1), first.z + (part >> 2)});
      if (fresh) {
        blocks[slot] = MapBlock{};
        blocks[slot].near_surface = ~BlockMask{};
        touched.fresh.push_back(slot);
      }
      touched.slots.push_back(slot);
    }
  }
  return touched;
}

void TsdfMap::add_numbers(MapBlock& block) {
  block.numbers = numbers.take();
  VoxelNumbers& all = numbers[block.numbers];
  all.distances_m.fill(0);
  all.weights.fill(0);
}

std::vector<std::uint32_t> TsdfMap::keep_near(const Eigen::Vector3d& sensor_m,
                                              const VoxelGrid& grid, const Config& config) {
  std::vector<std::uint32_t> removed;
  const double wide_block_m = kWideSide * config.voxel_size_m;
  if (kept_around_m_ && (*kept_around_m_ - sensor_m).norm() < wide_block_m) return removed;
  kept_around_m_ = sensor_m;
  // Blocks of this scan end no farther than this beyond the range.
  const double beyond_m = config.truncation_m() + 2 * wide_block_m;
  const double radius_m = config.map_radius_ranges * config.max_range_m + beyond_m;
  blocks.for_each_slot([&](std::uint32_t slot) {
    const BlockIndex wide = wide_of(blocks.index_of(slot));
    const Eigen::Vector3d centre_m =
        grid.corner_m({wide.x * kWideSide + kWideSide / 2, wide.y * kWideSide + kWideSide / 2,
                       wide.z * kWideSide + kWideSide / 2});
    if ((centre_m - sensor_m).squaredNorm() <= radius_m * radius_m) return;
    if (blocks[slot].numbers != kNoSlot) numbers.give_back(blocks[slot].numbers);
    blocks.erase(slot);
    removed.push_back(slot);
  });
  return removed;
}

}  // namespace mosbench::tsdf
