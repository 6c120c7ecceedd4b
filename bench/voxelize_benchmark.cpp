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
  expect(state, scan.measured.masks == staged.scan.measured.masks &&
                    scan.occupied == staged.scan.occupied &&
                    scan.voxel_of_point == staged.scan.voxel_of_point);
}

const RegisterStage registered("voxelize", voxelize_stage, true);

}  // namespace
}  // namespace mosbench
