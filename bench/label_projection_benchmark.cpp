#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/label_projection.hpp"
#include "core/methods/hmm_mos/threshold.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

void labels_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return project_labels(s.scan, shows_motion(s.threshold, min_otsu_score)
                                          ? united(s.dynamic, s.from_region)
                                          : VoxelSet{});
      },
      [](const StagedScan& s, const std::vector<std::uint32_t>& labels) {
        return labels == s.labels;
      });
  count_items(state, "points", mean_points(staged));
}

const RegisterStage registered("labels", labels_stage, false);

}  // namespace
}  // namespace mosbench
