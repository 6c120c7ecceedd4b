#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/change_detection.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// In every block the occupied voxels change from this scan's to the previous scan's.
void change_detection_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  std::vector<BlockStates> before, after;
  std::size_t expected = 0;
  const VoxelList& list = staged.last().observed;
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    const BlockMask& observed = list.masks[i];
    const BlockMask* now = staged.last().scan.occupied_in(list.blocks[i]);
    const BlockMask* then = staged.last_but_one().scan.occupied_in(list.blocks[i]);
    const BlockMask here = now == nullptr ? BlockMask{} : *now & observed;
    const BlockMask there = then == nullptr ? BlockMask{} : *then & observed;
    before.push_back({here, without(observed, here)});
    after.push_back({there, without(observed, there)});
    expected += without(here, there).count() + without(there, here).count();
  }
  std::size_t changed = 0;
  for (auto _ : state) {
    changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      changed += detect_changes(before[i], after[i]).count();
    }
    benchmark::DoNotOptimize(changed);
    benchmark::ClobberMemory();
  }
  count_items(state, "voxels", before.size() * kBlockVoxels);
  expect(state, changed == expected);
}

const RegisterStage registered("change_detection", change_detection_stage, false);

}  // namespace
}  // namespace mosbench
