#include "bench/near_blocks.hpp"

#include <array>

namespace mosbench {
namespace {

std::array<const VoxelSet*, 2> sources_of(const StagedScans& staged) {
  return {&staged.last().scan.measured, &staged.last_but_one().scan.measured};
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

}  // namespace mosbench
