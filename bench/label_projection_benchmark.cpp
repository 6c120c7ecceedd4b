#include "bench/stage_benchmark.hpp"
#include "core/label_projection.hpp"

namespace mosbench {
namespace {

void labels_stage(benchmark::State& state, StagedScan& staged, ThreadPool&) {
  std::vector<std::uint32_t> labels;
  for (auto _ : state) labels = project_labels(staged.scan, staged.moving);
  count_items(state, "points", labels.size());
  expect(state, labels == staged.labels);
}

const RegisterStage registered("labels", labels_stage, false);

}  // namespace
}  // namespace mosbench
