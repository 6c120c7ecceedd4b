#include <map>

#include "bench/stage_benchmark.hpp"
#include "core/dynablox/pipeline.hpp"

namespace mosbench {
namespace {

/// All scans of the workload from the first; one call is one scan on average. Counters hold the
/// milliseconds of each stage per scan.
void dynablox_stages(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  dynablox::Config config;
  config.max_range_m = staged.workload.config.max_range_m;
  std::map<std::string, double> stage_ms;
  double scans = 0;
  std::size_t labelled_points = 0, points = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    dynablox::Pipeline pipeline(config, {.threads = pool.size()});
    for (const StagedScan& s : staged.all) {
      const LabelledScan result =
          std::move(pipeline.push(s.frame.points, s.frame.map_from_sensor).front());
      for (const StageTime& stage : result.stages) {
        stage_ms[std::string(stage.name)] += stage.wall_ms;
      }
      labelled_points += result.labels.size();
      points += s.frame.points.size();
      ++scans;
    }
  }
  for (const auto& [name, ms] : stage_ms) state.counters[name + "_ms"] = ms / scans;
  expect(state, labelled_points == points && points > 0);
  count_items(state, "points", mean_points(staged));
}

const RegisterStage registered("dynablox", dynablox_stages, true);

}  // namespace
}  // namespace mosbench
