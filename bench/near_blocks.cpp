#include "bench/near_blocks.hpp"

#include <algorithm>
#include <array>

namespace mosbench {
namespace {

std::array<const VoxelSet*, 2> sources_of(const StagedScans& staged) {
  return {&staged.last().scan.measured, &staged.last_but_one().scan.measured};
}

/// Returns the squared distance from a cell of the middle block to the nearest source, over all
/// pairs.
int nearest(std::span<const SourceBlock* const> sources, int reach, const Voxel& cell) {
  const int side = 2 * reach + 1;
  int best = 1 << 20;
  for (int i = 0; i < side * side * side; ++i) {
    const BlockIndex block{i % side - reach, i / side % side - reach, i / side / side - reach};
    for_each_cell(sources[static_cast<std::size_t>(i)]->mask, [&](std::uint32_t source) {
      const Voxel v = voxel_at(block, source);
      const int dx = v.x - cell.x, dy = v.y - cell.y, dz = v.z - cell.z;
      best = std::min(best, dx * dx + dy * dy + dz * dz);
    });
  }
  return best;
}

}  // namespace

NearBlocks::NearBlocks(const StagedScans& staged)
    : filter_(staged.workload.config.voxel_size_m, staged.workload.config.sigma_m(),
              staged.workload.config.transition_epsilon,
              staged.workload.config.min_state_probability),
      field_(filter_.radius()),
      grid_(sources_of(staged), staged.last().observed.blocks, field_.reach()) {
  const auto side = static_cast<std::size_t>(2 * field_.reach() + 1);
  cube_ = side * side * side;
  ColumnDistances column(field_);
  BlockDistances distances;
  const VoxelList& observed = staged.last().observed;
  for (std::size_t i = 0; i < observed.blocks.size(); ++i) {
    const BlockIndex& block = observed.blocks[i];
    if (!grid_.any_around(block, field_.reach())) continue;
    blocks_.push_back(&block);
    observed_.push_back(&observed.masks[i]);
    sources_.resize(sources_.size() + cube_);
    const auto around = std::span(sources_).last(cube_);
    grid_.neighbours(block, field_.reach(), around);
    column.find(block, observed.masks[i], around, distances);
    with_source_ += distances.near.any();
  }
}

/// Checks every 61st wanted cell of every 97th block.
bool NearBlocks::equals_all_pairs() const {
  const int exact_below = far_squared(field_.radius());
  bool same = true;
  ColumnDistances column(field_);
  for (std::size_t i = 0; i < size(); ++i) {
    BlockDistances distances;
    find_distances(i, column, distances);
    if (i % 97 != 0) continue;
    for (std::uint32_t cell = 0; cell < kBlockVoxels; cell += 61) {
      if (observed(i).words[cell / 64] == 0) continue;
      const int expected = nearest(sources(i), field_.reach(), voxel_at({}, cell));
      same = same && (expected < exact_below
                          ? distances.near.test(cell) && distances.squared[cell] == expected
                          : !distances.near.test(cell));
    }
  }
  return same;
}

}  // namespace mosbench
