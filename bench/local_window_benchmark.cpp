#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Only the sums at occupied voxels have a meaning.
bool same_sums(const SumField& sums, const StagedScan& staged) {
  bool same = true;
  for (std::size_t i = 0; i < sums.blocks.size(); ++i) {
    for_each_cell(*staged.scan.occupied_in(sums.blocks[i]), [&](std::uint32_t cell) {
      same = same && sums.values[i][cell] == staged.sums.values[i][cell];
    });
  }
  return same;
}

void window_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  SumField sums;
  for (auto _ : state) sums = staged.window.sums(staged.scan);
  count_items(state, "voxels", staged.scan.occupied_count);
  expect(state, sums.values.size() == staged.sums.values.size() && same_sums(sums, staged));
}

const RegisterStage registered("window", window_stage, false);

}  // namespace
}  // namespace mosbench
