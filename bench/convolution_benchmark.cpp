#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

void convolution_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  ScoreField scores;
  for (auto _ : state) {
    scores = convolve(staged.scan, staged.changed, staged.workload.config.kernel_width_voxels,
                      staged.map, staged.k, pool);
  }
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, scores.values == staged.scores.values);
}

const RegisterStage registered("convolution", convolution_stage, true);

}  // namespace
}  // namespace mosbench
