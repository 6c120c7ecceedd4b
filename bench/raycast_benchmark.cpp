#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Counts the voxels that rays visit, counted once per ray.
std::size_t steps_of(const StagedScan& s, const Config& config) {
  Rays rays;
  collect_rays({s.scan.measured, s.scan.sensor_voxel, config.voxel_size_m, config.max_range_m}, {},
               0, rays);  // no ray is short
  std::size_t steps = 0;
  for (const Ray& ray : rays.long_rays) steps += static_cast<std::size_t>(ray.visits);
  return steps;
}

void raycast_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  RaycastScratch scratch;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return raycast(s.scan.measured, s.scan.sensor_voxel, config.voxel_size_m,
                       config.max_range_m, scratch, pool);
      },
      [](const StagedScan& s, const VoxelList& observed) {
        return voxels_of(observed) == voxels_of(s.observed);
      });
  count_items(state, "steps",
              mean_of(staged, [&](const StagedScan& s) { return steps_of(s, config); }));
  state.counters["voxels"] = static_cast<double>(
      mean_of(staged, [](const StagedScan& s) { return voxels_of(s.observed); }));
}

const RegisterStage registered("raycast", raycast_stage, true);

}  // namespace
}  // namespace mosbench
