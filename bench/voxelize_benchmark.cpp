#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

void voxelize_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return voxelize(s.frame.points, s.frame.map_from_sensor, staged.grid, config.min_range_m,
                        config.max_range_m, pool);
      },
      [](const StagedScan& s, const VoxelizedScan& scan) {
        return scan.measured.masks == s.scan.measured.masks && scan.occupied == s.scan.occupied &&
               scan.voxel_of_point == s.scan.voxel_of_point;
      });
  count_items(state, "points", mean_points(staged));
}

const RegisterStage registered("voxelize", voxelize_stage, true);

}  // namespace
}  // namespace mosbench
