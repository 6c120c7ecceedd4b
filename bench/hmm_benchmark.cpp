#include <cmath>

#include "bench/near_blocks.hpp"
#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

/// Returns the belief of a voxel whose squared distance was `squared` voxels in each of many scans.
double settled_belief(const Config& config, double squared) {
  const double ratio = config.voxel_size_m / config.sigma_m(), epsilon = config.transition_epsilon;
  const double likelihood = std::exp(-squared * ratio * ratio / 2);
  double p = likelihood;
  for (int scan = 0; scan < 100; ++scan) {
    const double q = epsilon + (1 - 2 * epsilon) * p;
    p = likelihood * q / (likelihood * q + (1 - likelihood) * (1 - q));
  }
  return p;
}

void hmm_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const NearBlocks near(staged);
  std::vector<BlockDistances> distances(near.size());
  std::vector<BlockBeliefs> beliefs(near.size());
  std::vector<BeliefNumbers> numbers(near.size());
  std::vector<BlockStates> states(near.size());
  std::size_t voxels = 0;
  ColumnDistances column(near.field());
  for (std::size_t i = 0; i < near.size(); ++i) {
    near.find_distances(i, column, distances[i]);
    voxels += near.observed(i).count();
  }
  const auto update = [&] {
    for (std::size_t i = 0; i < near.size(); ++i) {
      near.filter().update(near.observed(i), distances[i], beliefs[i], numbers[i], states[i]);
    }
  };
  for (int scan = 0; scan < 100; ++scan) update();
  for (auto _ : state) update();
  count_items(state, "voxels", voxels);
  for (std::size_t i = 0; i < near.size(); ++i) {
    for_each_cell(near.observed(i) & distances[i].near, [&](std::uint32_t cell) {
      const double expected = settled_belief(staged.workload.config, distances[i].squared[cell]);
      expect(state, std::abs(beliefs[i].at(cell, numbers[i]) - expected) < 1e-3);
    });
  }
}

const RegisterStage registered("hmm_update", hmm_stage, false);

}  // namespace
}  // namespace mosbench
