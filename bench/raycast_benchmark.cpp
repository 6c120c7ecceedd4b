#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

std::size_t voxels_of(const VoxelList& observed) {
  std::size_t voxels = 0;
  for (const BlockMask& mask : observed.masks) voxels += mask.count();
  return voxels;
}

/// Voxels visited by the rays, each ray's own.
std::size_t steps_of(const StagedScan& staged) {
  const Config& config = staged.workload.config;
  Rays rays;
  collect_rays(
      {staged.scan.measured, staged.scan.sensor_voxel, config.voxel_size_m, config.max_range_m}, {},
      0, rays);  // no ray is short
  std::size_t steps = 0;
  for (const Ray& ray : rays.long_rays) steps += static_cast<std::size_t>(ray.visits);
  return steps;
}

void raycast_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  RaycastScratch scratch;
  VoxelList observed;
  for (auto _ : state) {
    observed = raycast(staged.scan.measured, staged.scan.sensor_voxel, config.voxel_size_m,
                       config.max_range_m, scratch, pool);
  }
  count_items(state, "steps", steps_of(staged));
  state.counters["voxels"] = static_cast<double>(voxels_of(observed));
  expect(state, voxels_of(observed) == voxels_of(staged.observed));
}

const RegisterStage registered("raycast", raycast_stage, true);

}  // namespace
}  // namespace mosbench
