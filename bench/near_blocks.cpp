#include "bench/near_blocks.hpp"

#include <array>

namespace mosbench {
namespace {

std::array<const VoxelSet*, 2> sources_of(const StagedScan& staged) {
  return {&staged.scan.measured, &staged.previous.measured};
}

}  // namespace

NearBlocks::NearBlocks(const StagedScan& staged)
    : filter_(staged.workload.config.voxel_size_m, staged.workload.config.sigma_m(),
              staged.workload.config.transition_epsilon,
              staged.workload.config.min_state_probability),
      field_(filter_.radius()),
      grid_(sources_of(staged), staged.observed.blocks, field_.reach()) {
  const auto side = static_cast<std::size_t>(2 * field_.reach() + 1);
  cube_ = side * side * side;
  BlockDistances distances;
  for (std::size_t i = 0; i < staged.observed.blocks.size(); ++i) {
    const BlockIndex& block = staged.observed.blocks[i];
    if (!grid_.any_around(block, field_.reach())) continue;
    observed_.push_back(&staged.observed.masks[i]);
    sources_.resize(sources_.size() + cube_);
    const auto around = std::span(sources_).last(cube_);
    grid_.neighbours(block, field_.reach(), around);
    with_source_ += field_.squared_distances(around, distances);
  }
}

}  // namespace mosbench
