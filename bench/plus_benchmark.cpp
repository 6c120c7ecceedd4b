#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos_plus/look_back.hpp"
#include "core/methods/hmm_mos_plus/objects.hpp"
#include "core/methods/hmm_mos_plus/pipeline.hpp"
#include "core/methods/hmm_mos_plus/tracks.hpp"
#include "core/voxel/point_labels.hpp"

namespace mosbench {
namespace {

/// The stages that hmm-mos-plus has beside those of the map.
enum class PlusStage { kHistory, kArrivals, kGround, kLookBack, kPrediction, kObjects };

using PlusConfig = hmm_mos_plus::Config;

/// The defaults, with the voxels and the range of the workload.
PlusConfig plus_config(const Config& limits) {
  PlusConfig config;
  config.map.voxel_size_m = limits.voxel_size_m;
  config.map.min_range_m = limits.min_range_m;
  config.map.max_range_m = limits.max_range_m;
  return config;
}

std::vector<std::vector<std::uint32_t>> plus_labels(const StagedScans& staged) {
  hmm_mos_plus::Pipeline pipeline(plus_config(staged.workload.config));
  std::vector<std::vector<std::uint32_t>> labels;
  for (const StagedScan& s : staged.all) {
    labels.push_back(
        std::move(pipeline.push(s.frame.points, s.frame.map_from_sensor).at(0).labels));
  }
  return labels;
}

VoxelList update_plus_map(VoxelMap& map, const StagedScan& s, ThreadPool& pool) {
  const std::array sources{&s.scan.measured};
  return map.update(s.observed, sources, s.scan.sensor_m, s.k, pool);
}

/// Measures one stage; the others run untimed. The map has memory, so each pass starts before the
/// first scan. `history` is the whole update of a map that keeps one.
template <PlusStage stage>
void plus_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const std::vector<std::vector<std::uint32_t>> expected = plus_labels(staged);
  const PlusConfig config = plus_config(staged.workload.config);
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    VoxelMap map(config.map, staged.grid, VoxelMap::Keeps::kStatesAndHistory);
    hmm_mos_plus::LookBack past(config);
    hmm_mos_plus::Tracks tracks(config);
    for (const StagedScan& s : staged.all) {
      const bool measured = s.k >= staged.measured.front().k;
      const auto run = [&](PlusStage which, auto&& work) {
        return which == stage && measured ? timed_call(state, work) : work();
      };
      if (measured) staged.run_other_stages();
      const StagedScan inputs = s;
      run(PlusStage::kHistory, [&] { return update_plus_map(map, inputs, pool); });
      map.evict(s.k);
      auto classes = run(PlusStage::kArrivals, [&] {
        return hmm_mos_plus::classify(inputs.scan, map, s.k, config, pool);
      });
      const auto ground = run(PlusStage::kGround, [&] {
        return std::make_shared<const hmm_mos_plus::Ground>(inputs.scan, config);
      });
      hmm_mos_plus::LowVoxels low(inputs.scan, *ground);
      const hmm_mos::Tick tick{.at = s.k};
      run(PlusStage::kLookBack, [&] {
        past.enter(inputs.scan, classes, ground, tick, map, s.k, pool);
        return 0;
      });
      run(PlusStage::kPrediction, [&] {
        past.add_seeds(inputs.scan, low, classes);
        tracks.add_seeds(inputs.scan, low, tick, classes);
        return 0;
      });
      const auto motion = run(PlusStage::kObjects, [&] {
        return hmm_mos_plus::find_motion(inputs.scan, classes, *ground, low, config);
      });
      run(PlusStage::kPrediction, [&] {
        tracks.follow(inputs.scan, motion.components, tick);
        return 0;
      });
      auto moving = motion.objects;
      for (std::size_t i = 0; i < moving.size(); ++i) moving[i] = moving[i] | motion.feet[i];
      right = right && project_labels(inputs.scan, moving) == expected.at(s.k);
    }
  });
  expect(state, right);
  count_items(state, "voxels", mean_occupied(staged));
}

const RegisterStage history("plus_map_update", plus_stage<PlusStage::kHistory>, true);
const RegisterStage arrivals("plus_arrivals", plus_stage<PlusStage::kArrivals>, true);
const RegisterStage ground("plus_ground", plus_stage<PlusStage::kGround>, false);
const RegisterStage look_back("plus_look_back", plus_stage<PlusStage::kLookBack>, true);
const RegisterStage prediction("plus_prediction", plus_stage<PlusStage::kPrediction>, false);
const RegisterStage objects("plus_objects", plus_stage<PlusStage::kObjects>, false);

}  // namespace
}  // namespace mosbench
