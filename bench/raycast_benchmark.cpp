#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

std::size_t voxels_of(const ObservedVoxels& observed) {
  std::size_t voxels = 0;
  for (const BlockMask& mask : observed.masks) voxels += mask.count();
  return voxels;
}

void raycast_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  RaycastScratch scratch;
  ObservedVoxels observed;
  for (auto _ : state) {
    observed = raycast(staged.scan.measured, staged.scan.sensor_voxel, config.voxel_size_m,
                       config.max_range_m, scratch, pool);
  }
  count_items(state, "steps", staged.ray_steps);
  state.counters["voxels"] = static_cast<double>(voxels_of(observed));
  expect(state, voxels_of(observed) == voxels_of(staged.observed));
}

const RegisterStage registered("raycast", raycast_stage, true);

}  // namespace
}  // namespace mosbench
