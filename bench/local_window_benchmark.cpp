#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Compares the sums at occupied voxels; others have no meaning.
bool same_sums(const SumField& sums, const StagedScan& s) {
  bool same = sums.values.size() == s.sums.values.size();
  for (std::size_t i = 0; same && i < sums.blocks.size(); ++i) {
    for_each_cell(*s.scan.occupied_in(sums.blocks[i]), [&](std::uint32_t cell) {
      same = same && sums.values[i][cell] == s.sums.values[i][cell];
    });
  }
  return same;
}

void window_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const std::size_t first = staged.measured.front().k;
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    LocalWindow window(staged.workload.config.local_window_scans);
    for (std::size_t k = 0; k < first; ++k) window.join(staged.all[k].filtered);
    for (const StagedScan& s : staged.measured) {
      staged.run_other_stages();
      VoteField filtered = s.filtered;
      const VoxelizedScan scan = s.scan;
      const SumField sums = timed_call(state, [&] {
        window.join(std::move(filtered));
        return window.sums(scan);
      });
      right = right && same_sums(sums, s);
    }
  });
  expect(state, right);
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("window", window_stage, false);

}  // namespace
}  // namespace mosbench
