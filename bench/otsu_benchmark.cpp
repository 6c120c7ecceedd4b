#include "bench/stage_benchmark.hpp"
#include "core/selection.hpp"

namespace mosbench {
namespace {

void otsu_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  std::optional<double> threshold;
  VoxelSet dynamic;
  for (auto _ : state) {
    threshold = threshold_of(staged.scan, staged.sums);
    dynamic = select_dynamic(staged.scan, staged.sums, threshold, staged.carried, min_otsu_score);
  }
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, threshold == staged.threshold && dynamic.masks == staged.dynamic.masks);
}

const RegisterStage registered("otsu", otsu_stage, false);

}  // namespace
}  // namespace mosbench
