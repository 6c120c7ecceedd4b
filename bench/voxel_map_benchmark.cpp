#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

std::size_t voxels_of(const std::vector<BlockMask>& masks) {
  std::size_t voxels = 0;
  for (const BlockMask& mask : masks) voxels += mask.count();
  return voxels;
}

/// This scan and the one before in turns, so that states keep changing.
void map_update_stage(benchmark::State& state, StagedScan& staged, ThreadPool& pool) {
  const std::size_t voxels =
      (voxels_of(staged.observed.masks) + voxels_of(staged.previous_observed.masks)) / 2;
  const std::vector<const VoxelSet*> sources{&staged.scan.measured, &staged.previous.measured};
  const auto update = [&](VoxelMap& map, std::uint32_t k, ThreadPool& threads) {
    const bool odd = k % 2 != 0;
    return map.update(odd ? staged.previous_observed : staged.observed, sources,
                      (odd ? staged.previous : staged.scan).sensor_m, k, threads);
  };
  for (auto _ : state) benchmark::DoNotOptimize(update(staged.map, ++staged.k, pool));
  count_items(state, "voxels", voxels);
  state.counters["bytes/map voxel"] = static_cast<double>(staged.map.memory_bytes()) /
                                      static_cast<double>(staged.map.block_count() * kBlockVoxels);
  // Threads must not matter: two fresh maps, both scans each.
  ThreadPool one(1);
  VoxelMap alone(staged.workload.config, Variant::kPaper2024, staged.grid);
  VoxelMap together(staged.workload.config, Variant::kPaper2024, staged.grid);
  for (std::uint32_t k = 0; k < 6; ++k) {
    expect(state, update(alone, k, one).masks == update(together, k, pool).masks);
  }
  expect(state, alone.block_count() == together.block_count() && alone.block_count() > 0);
}

/// One call is one scan; in sixteen every block is looked at once.
void evict_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  constexpr std::uint32_t kScans = 16;
  const std::size_t blocks = staged.map.block_count();
  while (state.KeepRunningBatch(kScans)) {
    for (std::uint32_t i = 0; i < kScans; ++i) staged.map.evict(staged.k + i);
  }
  count_items(state, "blocks", blocks / kScans);
  expect(state, staged.map.block_count() == blocks);
  // Once everything has expired every block goes.
  const auto late =
      staged.k + static_cast<std::uint32_t>(staged.workload.config.global_window_scans) + 2;
  for (std::uint32_t i = 0; i < kScans; ++i) staged.map.evict(late + i);
  expect(state, staged.map.block_count() == 0);
}

const RegisterStage update_registered("map_update", map_update_stage, true);
const RegisterStage evict_registered("evict", evict_stage, false);

}  // namespace
}  // namespace mosbench
