#include "bench/stage_benchmark.hpp"
#include "core/hmm_mos/selection.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

void otsu_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return select_dynamic(s.scan, s.sums, threshold_of(s.scan, s.sums), s.carried,
                              min_otsu_score);
      },
      [](const StagedScan& s, const VoxelSet& dynamic) {
        return dynamic.masks == s.dynamic.masks && threshold_of(s.scan, s.sums) == s.threshold;
      });
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("otsu", otsu_stage, false);

}  // namespace
}  // namespace mosbench
