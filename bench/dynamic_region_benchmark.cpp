#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// The region has memory, so each pass starts before the first scan and measures the last ones.
void dynamic_region_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  const std::size_t first = staged.measured.front().k;
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    VoxelMap map = staged.map_after(first, pool);
    DynamicRegion region = staged.new_region();
    for (std::size_t k = 0; k < first; ++k) {
      const StagedScan& s = staged.all[k];
      if (s.labels.empty()) continue;  // not judged yet
      region.update({s.scan, s.dynamic, s.from_region, s.beside, s.threshold}, s.k);
    }
    for (const StagedScan& s : staged.measured) {
      staged.run_other_stages();
      staged.enter(map, s, pool);
      votes_for(s, map, width, pool);
      const StagedScan inputs = s;
      const VoxelSet from_region = timed_call(state, [&] {
        const VoxelSet beside = beside_unknown_of(inputs, region, map, width, pool);
        VoxelSet chosen = region.back_end(inputs.scan, beside, width, pool);
        region.update({inputs.scan, inputs.dynamic, chosen, beside, s.threshold}, s.k);
        return chosen;
      });
      right = right && from_region.masks == s.from_region.masks;
    }
  });
  expect(state, right);
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("dynamic_region", dynamic_region_stage, true);

}  // namespace
}  // namespace mosbench
