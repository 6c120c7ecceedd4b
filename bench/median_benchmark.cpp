#include "bench/stage_benchmark.hpp"
#include "core/median.hpp"

namespace mosbench {
namespace {

void median_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  ScoreField filtered;
  for (auto _ : state) filtered = median_filter(staged.scan, staged.scores, pool);
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, filtered.values == staged.filtered.values);
}

const RegisterStage registered("median", median_stage, true);

}  // namespace
}  // namespace mosbench
