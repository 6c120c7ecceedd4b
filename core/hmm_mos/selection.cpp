#include "core/hmm_mos/selection.hpp"

#include "core/hmm_mos/convolution.hpp"
#include "core/voxel/halo.hpp"

namespace mosbench::hmm_mos {

std::optional<double> threshold_of(const VoxelizedScan& scan, const SumField& sums) {
  std::vector<ValueCount> values;
  std::size_t zeros = scan.occupied_count;
  for (std::size_t i = 0; i < sums.blocks.size(); ++i) {
    const BlockMask* occupied = scan.occupied_in(sums.blocks[i]);
    for_each_cell(*occupied, [&](std::uint32_t cell) {
      const std::int32_t sum = sums.values[i][cell];
      if (sum == 0) return;
      values.push_back({sum, 1});
      --zeros;
    });
  }
  values.push_back({0, zeros});
  return otsu_threshold(values);
}

VoxelSet select_dynamic(const VoxelizedScan& scan, const SumField& sums,
                        std::optional<double> threshold, const VoxelSet& carried,
                        int min_otsu_score) {
  VoxelSet selected;
  for (std::size_t i = 0; i < sums.blocks.size(); ++i) {
    const BlockMask* carried_here = carried.mask_of(sums.blocks[i]);
    BlockMask chosen;
    for_each_cell(*scan.occupied_in(sums.blocks[i]), [&](std::uint32_t cell) {
      const std::int32_t sum = sums.values[i][cell];
      const bool above = threshold && sum > *threshold;
      const bool kept = carried_here != nullptr && carried_here->test(cell) && sum > min_otsu_score;
      if (above || kept) chosen.set(cell);
    });
    if (chosen.any()) selected.masks[selected.insert(sums.blocks[i])] = chosen;
  }
  VoxelSet dilated;
  HaloRows rows;
  for (const std::uint32_t slot : slots_within(scan, selected, 1)) {
    Neighbourhood masks{};
    for_each_neighbour(scan.measured.blocks[slot],
                       [&](std::size_t position, const BlockIndex& block) {
                         masks[position] = selected.mask_of(block);
                       });
    gather_halo(masks, 1, rows);
    const BlockMask here = dilate(rows) & scan.occupied[slot];
    if (here.any()) dilated.masks[dilated.insert(scan.measured.blocks[slot])] = here;
  }
  return dilated;
}

VoxelSet united(VoxelSet some, const VoxelSet& more) {
  for (std::size_t i = 0; i < more.block_count(); ++i) {
    BlockMask& mask = some.masks[some.insert(more.blocks[i])];
    mask = mask | more.masks[i];
  }
  return some;
}

}  // namespace mosbench::hmm_mos
