#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// This scan and the one before in turns, so that states keep changing.
void map_update_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  std::size_t voxels = 0, changed = 0;
  for (const BlockMask& mask : staged.observed.masks) voxels += mask.count();
  const std::vector<const VoxelSet*> sources{&staged.scan.measured, &staged.previous.measured};
  for (auto _ : state) {
    const bool odd = ++staged.k % 2 != 0;
    const VoxelizedScan& scan = odd ? staged.previous : staged.scan;
    const ObservedVoxels& observed = odd ? staged.previous_observed : staged.observed;
    changed = staged.map.update(observed, sources, scan.sensor_m, staged.k, pool).blocks.size();
  }
  count_items(state, "voxels", voxels);
  state.counters["bytes/map voxel"] = static_cast<double>(staged.map.memory_bytes()) /
                                      static_cast<double>(staged.map.block_count() * kBlockVoxels);
  expect(state, changed == staged.map.changed_since(staged.k).block_count());
}

void evict_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  const std::size_t blocks = staged.map.block_count();
  for (auto _ : state) staged.map.evict(staged.k);
  count_items(state, "blocks", blocks);
  expect(state, staged.map.block_count() == blocks);
}

const RegisterStage update_registered("map_update", map_update_stage, true);
const RegisterStage evict_registered("evict", evict_stage, false);

}  // namespace
}  // namespace mosbench
