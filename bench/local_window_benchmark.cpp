#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

void window_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  SumField sums;
  for (auto _ : state) sums = staged.window.sums(staged.scan);
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, sums.blocks == staged.sums.blocks);
}

const RegisterStage registered("window", window_stage, false);

}  // namespace
}  // namespace mosbench
