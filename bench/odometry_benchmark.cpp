#include <mosbench/odometry.hpp>

#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Poses of all scans of the workload from the first; one call is one scan on average.
void odometry_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool,
                    std::string_view name) {
  const OdometryKind& kind = *find_odometry(name);
  double worst_m = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    const std::unique_ptr<Odometry> odometry = kind.make(kind.defaults, pool.size());
    const Pose first_from_map = staged.all.front().frame.map_from_sensor.inverse();
    for (const StagedScan& s : staged.all) {
      const Pose found = odometry->push(s.frame.points).map_from_sensor;
      const Pose truth = first_from_map * s.frame.map_from_sensor;
      worst_m = std::max(worst_m, (found.translation() - truth.translation()).norm());
    }
  }
  state.counters["worst_m"] = worst_m;
  expect(state, worst_m < 2.0);
  count_items(state, "points", mean_points(staged));
}

void simple_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  odometry_stage(state, staged, pool, "simple");
}
void kiss_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  odometry_stage(state, staged, pool, "kiss");
}

const RegisterStage simple_registered("odometry_simple", simple_stage, true);
const RegisterStage kiss_registered("odometry_kiss", kiss_stage, true);

}  // namespace
}  // namespace mosbench
