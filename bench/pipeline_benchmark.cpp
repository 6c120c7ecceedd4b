#include "bench/stage_benchmark.hpp"
#include "core/pipeline.hpp"

namespace mosbench {
namespace {

/// All scans of the workload from the first; one call is one scan on average.
void pipeline_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const std::vector<Frame>& frames = staged.workload.frames;
  std::size_t points = 0;
  for (const Frame& frame : frames) points += frame.points.size();
  std::vector<std::uint32_t> labels;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(frames.size()))) {
    Pipeline pipeline(staged.workload.config, Variant::kPaper2024, pool.size());
    for (const Frame& frame : frames) {
      labels = std::move(pipeline.push(frame.points, frame.map_from_sensor)[0].labels);
    }
  }
  count_items(state, "points", points / frames.size());
  expect(state, labels == staged.labels);
}

const RegisterStage registered("pipeline", pipeline_stage, true);

}  // namespace
}  // namespace mosbench
