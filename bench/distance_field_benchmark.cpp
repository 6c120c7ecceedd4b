#include "bench/near_blocks.hpp"
#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

void distance_field_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  const NearBlocks near(staged);
  BlockDistances distances;
  std::size_t blocks = 0;
  for (auto _ : state) {
    blocks = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      blocks += near.field().squared_distances(near.sources(i), distances);
      benchmark::DoNotOptimize(distances);
    }
  }
  count_items(state, "blocks", near.size());
  expect(state, blocks == near.with_source());
}

const RegisterStage registered("distance_field", distance_field_stage, false);

}  // namespace
}  // namespace mosbench
