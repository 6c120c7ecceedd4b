#include <algorithm>

#include "bench/near_blocks.hpp"
#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Returns the squared distance from a cell of the middle block to the nearest source, over all
/// pairs.
int nearest(std::span<const SourceBlock* const> sources, int reach, const Voxel& cell) {
  const int side = 2 * reach + 1;
  int best = 1 << 20;
  for (int i = 0; i < side * side * side; ++i) {
    const BlockIndex block{i % side - reach, i / side % side - reach, i / side / side - reach};
    for_each_cell(sources[static_cast<std::size_t>(i)]->mask, [&](std::uint32_t source) {
      const Voxel v = voxel_at(block, source);
      const int dx = v.x - cell.x, dy = v.y - cell.y, dz = v.z - cell.z;
      best = std::min(best, dx * dx + dy * dy + dz * dz);
    });
  }
  return best;
}

/// Checks every 61st wanted cell of every 97th block.
bool equals_all_pairs(const NearBlocks& near) {
  const int exact_below = far_squared(near.field().radius());
  bool same = true;
  ColumnDistances column(near.field());
  for (std::size_t i = 0; i < near.size(); ++i) {
    BlockDistances distances;
    near.find_distances(i, column, distances);
    if (i % 97 != 0) continue;
    for (std::uint32_t cell = 0; cell < kBlockVoxels; cell += 61) {
      if (near.observed(i).words[cell / 64] == 0) continue;
      const int expected = nearest(near.sources(i), near.field().reach(), voxel_at({}, cell));
      same = same && (expected < exact_below
                          ? distances.near.test(cell) && distances.squared[cell] == expected
                          : !distances.near.test(cell));
    }
  }
  return same;
}

void distance_field_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const NearBlocks near(staged);
  BlockDistances distances;
  std::size_t blocks = 0;
  for (auto _ : state) {
    blocks = 0;
    ColumnDistances column(near.field());
    for (std::size_t i = 0; i < near.size(); ++i) {
      near.find_distances(i, column, distances);
      blocks += distances.near.any();
      benchmark::DoNotOptimize(distances);
    }
  }
  count_items(state, "blocks", near.size());
  expect(state, blocks == near.with_source() && equals_all_pairs(near));
}

const RegisterStage registered("distance_field", distance_field_stage, false);

}  // namespace
}  // namespace mosbench
