#include "core/methods/hmm_mos/otsu.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {
namespace {

constexpr int kBins = 100;

struct Limits {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Limits limits_of(std::span<const ValueCount> values) {
  Limits limits;
  for (const ValueCount& entry : values) {
    if (entry.count == 0) continue;
    limits.low = std::min(limits.low, static_cast<double>(entry.value));
    limits.high = std::max(limits.high, static_cast<double>(entry.value));
  }
  return limits;
}

std::size_t bin_of(double value, const Limits& limits) {
  if (value - limits.low < 1e-3) return 0;
  if (limits.high - value < 1e-3) return kBins - 1;
  const double width = (limits.high - limits.low) / kBins;
  return static_cast<std::size_t>(std::ceil((value - limits.low) / width)) - 1;
}

}  // namespace

std::optional<double> otsu_threshold(std::span<const ValueCount> values) {
  const Limits limits = limits_of(values);
  if (!(limits.low < limits.high)) return std::nullopt;
  std::array<double, kBins> counts{};
  for (const ValueCount& entry : values) {
    if (entry.count != 0) {
      counts[bin_of(entry.value, limits)] += static_cast<double>(entry.count);
    }
  }
  double total = 0, moment = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    total += counts[i];
    moment += static_cast<double>(i) * counts[i];
  }
  double below = 0, moment_below = 0, best = 0;
  std::optional<std::size_t> level;
  for (std::size_t i = 0; i < kBins; ++i) {
    const double above = total - below;
    if (below > 0 && above > 0) {
      const double gap = moment_below / below - (moment - moment_below) / above;
      const double between = below * above * (gap * gap);
      if (between >= best) {  // the highest of equal levels wins
        best = between;
        level = i + 1;
      }
    }
    below += counts[i];
    moment_below += static_cast<double>(i) * counts[i];
  }
  if (!level) return std::nullopt;
  return limits.low + static_cast<double>(*level - 1) * (limits.high - limits.low) / kBins;
}

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

VoxelSet dilate_occupied(const VoxelizedScan& scan, const VoxelSet& dynamic, ThreadPool& pool) {
  const std::vector<std::uint32_t> slots = slots_within(scan, dynamic, 1);
  std::vector<BlockMask> dilated(slots.size());
  for_each_block_near(
      dynamic, 1, scan, slots, pool,
      [&](std::size_t i, const HaloRows&, const BlockMask& reach) { dilated[i] = reach; });
  return set_of(scan, slots, dilated);
}

}  // namespace mosbench::hmm_mos
