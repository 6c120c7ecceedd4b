#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// The same scan again and again, each time one scan later.
void dynamic_region_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  std::size_t blocks = 0;
  std::uint32_t k = staged.k;
  for (auto _ : state) {
    const VoxelSet beside =
        beside_unknown(staged.scan, staged.region.blocks(), staged.dynamic.blocks, width,
                       staged.map, staged.k, pool);
    const VoxelSet chosen = staged.region.back_end(staged.scan, beside, width, pool);
    staged.region.update({staged.scan, staged.dynamic, chosen, beside, staged.threshold}, ++k);
    blocks = beside.block_count();
  }
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, blocks > 0 || staged.region.blocks().empty());
}

const RegisterStage registered("dynamic_region", dynamic_region_stage, true);

}  // namespace
}  // namespace mosbench
