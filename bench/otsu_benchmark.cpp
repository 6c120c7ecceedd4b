#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/dilation.hpp"
#include "core/methods/hmm_mos/threshold.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

void otsu_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return dilate_occupied(s.scan,
                               above_threshold(s.scan, s.sums, threshold_of(s.scan, s.sums),
                                               s.carried, min_otsu_score),
                               pool);
      },
      [](const StagedScan& s, const VoxelSet& dynamic) {
        return dynamic.masks == s.dynamic.masks && threshold_of(s.scan, s.sums) == s.threshold;
      });
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("otsu", otsu_stage, false);

}  // namespace
}  // namespace mosbench
