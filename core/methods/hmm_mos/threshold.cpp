#include "core/methods/hmm_mos/threshold.hpp"

#include <vector>

#include "core/methods/hmm_mos/otsu.hpp"

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

VoxelSet above_threshold(const VoxelizedScan& scan, const SumField& sums,
                         std::optional<double> threshold, const VoxelSet& carried,
                         int min_otsu_score) {
  VoxelSet dynamic;
  for (std::size_t i = 0; i < sums.blocks.size(); ++i) {
    const BlockMask* carried_here = carried.mask_of(sums.blocks[i]);
    BlockMask chosen;
    for_each_cell(*scan.occupied_in(sums.blocks[i]), [&](std::uint32_t cell) {
      const std::int32_t sum = sums.values[i][cell];
      const bool above = threshold && sum > *threshold;
      const bool kept = carried_here != nullptr && carried_here->test(cell) && sum > min_otsu_score;
      if (above || kept) chosen.set(cell);
    });
    if (chosen.any()) dynamic.masks[dynamic.insert(sums.blocks[i])] = chosen;
  }
  return dynamic;
}

}  // namespace mosbench::hmm_mos
