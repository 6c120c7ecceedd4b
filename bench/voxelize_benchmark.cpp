#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

void voxelize_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const Frame& frame = staged.workload.frames.back();
  const Config& config = staged.workload.config;
  VoxelizedScan scan;
  for (auto _ : state) {
    scan = voxelize(frame.points, frame.map_from_sensor, staged.grid, config.min_range_m,
                    config.max_range_m, pool);
  }
  count_items(state, "points", frame.points.size());
  expect(state, scan.occupied_count == staged.scan.occupied_count &&
                    scan.measured.block_count() == staged.scan.measured.block_count());
}

const RegisterStage registered("voxelize", voxelize_stage, true);

}  // namespace
}  // namespace mosbench
