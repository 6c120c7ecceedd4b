#include "bench/stage_benchmark.hpp"
#include "core/selection.hpp"

namespace mosbench {
namespace {

/// The same scan again and again, each time one scan later. The region is made anew before all that
/// joined it in this scan would leave it at once.
void dynamic_region_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  const Config& config = staged.workload.config;
  const std::uint32_t last_k =
      staged.k + static_cast<std::uint32_t>(config.dynamic_window_scans) / 2;
  std::uint32_t k = staged.k;
  VoxelSet beside;
  for (auto _ : state) {
    if (k == last_k) {
      state.PauseTiming();
      k = staged.k;
      staged.region = DynamicRegion(staged.grid, config.max_range_m, config.dynamic_window_scans,
                                    config.min_otsu_score);
      staged.region.update({staged.scan, staged.dynamic, {}, beside, staged.threshold}, k);
      state.ResumeTiming();
    }
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
  expect(state, staged.region.blocks().size() >= staged.dynamic.block_count() ||
                    !shows_motion(staged.threshold, config.min_otsu_score));
}

const RegisterStage registered("dynamic_region", dynamic_region_stage, true);

}  // namespace
}  // namespace mosbench
