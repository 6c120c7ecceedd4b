#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// The map has memory, so each pass starts before the first scan and measures the last ones.
void map_update_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const std::size_t first = staged.measured.front().k;
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    VoxelMap map = staged.map_after(first, pool);
    for (const StagedScan& s : staged.measured) {
      staged.run_other_stages();
      const StagedScan inputs = s;
      const VoxelList changed = timed_call(state, [&] { return staged.update(map, inputs, pool); });
      map.evict(s.k);
      right = right && voxels_of(changed) == s.state_changes;
    }
  });
  expect(state, right);
  count_items(state, "voxels",
              mean_of(staged, [](const StagedScan& s) { return voxels_of(s.observed); }));
  const VoxelMap last = staged.map_after(staged.all.size(), pool);
  state.counters["bytes/map voxel"] = static_cast<double>(last.memory_bytes()) /
                                      static_cast<double>(last.block_count() * kBlockVoxels);
}

/// One call is one scan; in sixteen scans every block is visited once.
void evict_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  constexpr std::uint32_t kScans = 16;
  const std::uint32_t k = staged.last().k;
  VoxelMap map = staged.map_after(k + 1, pool);
  const std::size_t blocks = map.block_count();
  measure_passes(state, kScans, [&] {
    for (std::uint32_t i = 0; i < kScans; ++i) {
      staged.run_other_stages();
      timed_call(state, [&] { return map.evict(k + i), 0; });
    }
  });
  count_items(state, "blocks", blocks / kScans);
  expect(state, map.block_count() == blocks);
  // Once everything has expired every block goes.
  const auto late = k + static_cast<std::uint32_t>(staged.workload.config.global_window_scans) + 2;
  for (std::uint32_t i = 0; i < kScans; ++i) map.evict(late + i);
  expect(state, map.block_count() == 0);
}

const RegisterStage update_registered("map_update", map_update_stage, true);
const RegisterStage evict_registered("evict", evict_stage, false);

}  // namespace
}  // namespace mosbench
