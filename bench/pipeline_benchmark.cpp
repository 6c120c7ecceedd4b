#include "bench/stage_benchmark.hpp"
#include "core/pipeline.hpp"

namespace mosbench {
namespace {

/// All scans of the workload from the first; one call is one scan on average. Counters hold the
/// stages' wall milliseconds of the last scan, which is the one that their own benchmarks are
/// about.
void pipeline_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const std::vector<Frame>& frames = staged.workload.frames;
  std::size_t points = 0;
  for (const Frame& frame : frames) points += frame.points.size();
  std::vector<std::uint32_t> labels;
  StageTimes last_ms{};
  double passes = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(frames.size()))) {
    Pipeline pipeline(staged.workload.config, Variant::kPaper2024, pool.size());
    for (const Frame& frame : frames) {
      ScanResult result = std::move(pipeline.push(frame.points, frame.map_from_sensor)[0]);
      labels = std::move(result.labels);
      if (&frame != &frames.back()) continue;
      for (std::size_t s = 0; s < last_ms.size(); ++s) last_ms[s] += result.stage_times[s];
    }
    ++passes;
  }
  for (std::size_t s = 0; s < last_ms.size(); ++s) {
    state.counters[std::string(kStageNames[s]) + "_ms"] = last_ms[s] / passes;
  }
  count_items(state, "points", points / frames.size());
  expect(state, labels == staged.labels);
}

const RegisterStage registered("pipeline", pipeline_stage, true);

}  // namespace
}  // namespace mosbench
