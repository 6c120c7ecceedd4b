#include "bench/stage_benchmark.hpp"
#include "core/hmm_mos/pipeline.hpp"

namespace mosbench {
namespace {

/// All scans of the workload from the first; one call is one scan on average. Counters hold the
/// stages' CPU milliseconds per scan over the scans that their own benchmarks are about.
void pipeline_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const std::size_t first_measured = staged.measured.front().k;
  std::array<double, kStageNames.size()> sum_ms{};
  std::vector<StageEvent> events;
  double scans = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    Pipeline pipeline(staged.workload.config, Variant::kPaper2024, pool.size());
    pipeline.record_stages(&events);
    for (const StagedScan& s : staged.all) {
      events.clear();
      const ScanResult result =
          std::move(pipeline.push(s.frame.points, s.frame.map_from_sensor)[0]);
      if (s.k < first_measured) continue;
      for (const StageEvent& event : events) {
        sum_ms[static_cast<std::size_t>(event.stage)] += event.cpu_ms;
      }
      ++scans;
      expect(state, result.labels == s.labels);
    }
  }
  for (std::size_t i = 0; i < sum_ms.size(); ++i) {
    state.counters[std::string(kStageNames[i]) + "_cpu_ms"] = sum_ms[i] / scans;
  }
  count_items(state, "points", mean_points(staged));
}

const RegisterStage registered("pipeline", pipeline_stage, true);

}  // namespace
}  // namespace mosbench
