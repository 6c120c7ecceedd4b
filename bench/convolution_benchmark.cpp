#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Measures on a map that was just updated, as in the pipeline.
void convolution_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  const std::size_t first = staged.measured.front().k;
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    VoxelMap map = staged.map_after(first, pool);
    for (const StagedScan& s : staged.measured) {
      staged.run_other_stages();
      staged.enter(map, s, pool);
      const VoteField votes = timed_call(state, [&] { return votes_for(s, map, width, pool); });
      right = right && votes.values == s.votes.values;
    }
  });
  expect(state, right);
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("convolution", convolution_stage, true);

}  // namespace
}  // namespace mosbench
