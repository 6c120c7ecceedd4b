#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// The same scan again and again, each time one scan later.
void dynamic_region_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  std::uint32_t k = staged.k;
  VoxelSet beside;
  for (auto _ : state) {
    beside = beside_unknown(staged.scan, staged.region.blocks(), staged.dynamic.blocks, width,
                            staged.map, staged.k, pool);
    const VoxelSet chosen = staged.region.back_end(staged.scan, beside, width, pool);
    staged.region.update({staged.scan, staged.dynamic, chosen, beside, staged.threshold}, ++k);
  }
  count_items(state, "voxels", staged.scan.occupied_count);
  // What the back-end chooses is occupied, known all around and not more than there is.
  const VoxelSet chosen = staged.region.back_end(staged.scan, beside, width, pool);
  for (std::size_t i = 0; i < chosen.block_count(); ++i) {
    const BlockMask* hidden = beside.mask_of(chosen.blocks[i]);
    const BlockMask* occupied = staged.scan.occupied_in(chosen.blocks[i]);
    expect(state, occupied != nullptr && !without(chosen.masks[i], *occupied).any());
    expect(state, hidden == nullptr || !(chosen.masks[i] & *hidden).any());
  }
  expect(state, staged.region.blocks().size() >= staged.dynamic.block_count() || !staged.threshold);
}

const RegisterStage registered("dynamic_region", dynamic_region_stage, true);

}  // namespace
}  // namespace mosbench
