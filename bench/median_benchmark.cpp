#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/median.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

void median_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  measure_stage(
      state, staged, [&](const StagedScan& s) { return median_filter(s.scan, s.votes, pool); },
      [](const StagedScan& s, const VoteField& filtered) {
        return filtered.values == s.filtered.values;
      });
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage registered("median", median_stage, true);

}  // namespace
}  // namespace mosbench
