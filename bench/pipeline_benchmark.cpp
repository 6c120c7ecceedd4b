#include <map>
#include <string>

#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// Measures all scans of the workload from the first; one call is one scan on average. Counters
/// hold the stages' CPU milliseconds per scan, over the scans on which the stages are measured
/// alone.
void pipeline_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const std::size_t first_measured = staged.measured.front().k;
  std::map<std::string, double> sum_ms;
  double scans = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    Pipeline pipeline(staged.workload.config, {.threads = pool.size(), .cpu_times = true});
    for (const StagedScan& s : staged.all) {
      const LabelledScan result =
          std::move(pipeline.push(s.frame.points, s.frame.map_from_sensor)[0]);
      if (s.k < first_measured) continue;
      for (const StageTime& stage : result.stages) sum_ms[std::string(stage.name)] += stage.cpu_ms;
      ++scans;
      expect(state, result.labels == s.labels);
    }
  }
  for (const auto& [stage, sum] : sum_ms) state.counters[stage + "_cpu_ms"] = sum / scans;
  count_items(state, "points", mean_points(staged));
}

const RegisterStage registered("pipeline", pipeline_stage, true);

}  // namespace
}  // namespace mosbench
