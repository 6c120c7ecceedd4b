#include <array>
#include <map>
#include <mosbench/odometry.hpp>
#include <optional>

#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos_plus/objects.hpp"
#include "core/methods/hmm_mos_plus/pipeline.hpp"
#include "core/methods/hmm_mos_plus/tracks.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench {
namespace {

using Labels = std::vector<std::vector<std::uint32_t>>;
using PlusConfig = hmm_mos_plus::Config;

Labels labels_of(Method& method, const StagedScans& staged) {
  Labels labels;
  for (const StagedScan& s : staged.all) {
    labels.push_back(std::move(method.push(s.frame.points, s.frame.map_from_sensor).at(0).labels));
  }
  return labels;
}

/// Measures all scans of the workload from the first; one call is one scan on average. Counters
/// hold the stages' CPU milliseconds per scan from scan `first` on, and what the method holds after
/// the last scan in MB. `right(s, labels)` tells whether labels of those scans are right.
template <typename Make, typename Right>
void measure_method(benchmark::State& state, const StagedScans& staged, std::size_t first,
                    Make&& make, Right&& right) {
  std::map<std::string, double> sum_ms;
  double scans = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    const auto method = make();
    for (const StagedScan& s : staged.all) {
      const LabelledScan result =
          std::move(method->push(s.frame.points, s.frame.map_from_sensor).at(0));
      if (s.k < first) continue;
      for (const StageTime& stage : result.stages) sum_ms[std::string(stage.name)] += stage.cpu_ms;
      ++scans;
      expect(state, right(s, result.labels));
    }
    if (const std::optional<MemoryUse> use = method->memory()) {
      state.counters["memory_MB"] = static_cast<double>(use->bytes) / 1e6;
    }
  }
  for (const auto& [stage, sum] : sum_ms) state.counters[stage + "_cpu_ms"] = sum / scans;
  count_items(state, "points", mean_points(staged));
}

/// Counts the scans on which the stages are measured alone.
void pipeline_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const RunContext context{.threads = pool.size(), .cpu_times = true};
  measure_method(
      state, staged, staged.measured.front().k,
      [&] { return std::make_unique<Pipeline>(staged.workload.config, context); },
      [](const StagedScan& s, const auto& labels) { return labels == s.labels; });
}

/// A method by name, with the range limits of the workload. Labels must be those of one thread.
void method_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool,
                  const MethodKind& kind) {
  Settings settings = kind.defaults;
  settings.set("min_range_m", staged.workload.config.min_range_m);
  settings.set("max_range_m", staged.workload.config.max_range_m);
  const Labels expected = labels_of(*kind.make(settings, {.cpu_times = true}), staged);
  measure_method(
      state, staged, 0,
      [&] { return kind.make(settings, {.threads = pool.size(), .cpu_times = true}); },
      [&](const StagedScan& s, const auto& labels) { return labels == expected[s.k]; });
}

/// The stages that hmm-mos-plus has beside those of the map.
enum class PlusStage { kHistory, kArrivals, kGround, kLookBack, kPrediction, kObjects };

/// The defaults, with the voxels and the range of the workload.
PlusConfig plus_config(const Config& limits) {
  PlusConfig config;
  config.map.voxel_size_m = limits.voxel_size_m;
  config.map.min_range_m = limits.min_range_m;
  config.map.max_range_m = limits.max_range_m;
  return config;
}

/// Measures one stage; the others run untimed. The map has memory, so each pass starts before the
/// first scan. `history` is the whole update of a map that keeps one.
template <PlusStage stage>
void plus_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const PlusConfig config = plus_config(staged.workload.config);
  hmm_mos_plus::Pipeline whole(config);
  const Labels expected = labels_of(whole, staged);
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    hmm_mos_plus::BlockMemory memory;
    VoxelMap map(config.map, staged.grid, &memory);
    hmm_mos_plus::LookBack past(config);
    hmm_mos_plus::Tracks tracks(config);
    hmm_mos_plus::Attachments attachments(config);
    for (const StagedScan& s : staged.all) {
      const bool measured = s.k >= staged.measured.front().k;
      const auto run = [&](PlusStage which, auto&& work) {
        return which == stage && measured ? timed_call(state, work) : work();
      };
      if (measured) staged.run_other_stages();
      const StagedScan inputs = s;
      run(PlusStage::kHistory, [&] {
        const std::array sources{&inputs.scan.measured};
        return map.update(inputs.observed, sources, inputs.scan.sensor_m, s.k, pool);
      });
      map.evict(s.k);
      auto classes = run(PlusStage::kArrivals, [&] {
        return hmm_mos_plus::classify(inputs.scan, {map, memory, s.k}, config, pool);
      });
      const auto ground = run(PlusStage::kGround, [&] {
        return std::make_shared<const hmm_mos_plus::Ground>(inputs.scan, config);
      });
      hmm_mos_plus::LowVoxels low(inputs.scan, *ground);
      const hmm_mos_plus::Tick tick{.at = s.k};
      run(PlusStage::kLookBack, [&] {
        past.enter(inputs.scan, classes, ground, tick, {map, memory, s.k}, pool);
        return 0;
      });
      run(PlusStage::kPrediction, [&] {
        past.add_seeds(inputs.scan, low, classes);
        tracks.add_seeds(inputs.scan, low, tick, classes);
        return 0;
      });
      const auto motion = run(PlusStage::kObjects, [&] {
        auto found = hmm_mos_plus::find_components(inputs.scan, classes, *ground, low, config);
        tracks.follow(inputs.scan, found, tick);
        attachments.judge(inputs.scan, classes, low, s.k, {map, memory, s.k}, found);
        return hmm_mos_plus::motion_of(inputs.scan, classes, low, std::move(found));
      });
      auto moving = motion.objects;
      for (std::size_t i = 0; i < moving.size(); ++i) moving[i] = moving[i] | motion.feet[i];
      right = right && project_labels(inputs.scan, moving) == expected.at(s.k);
    }
  });
  expect(state, right);
  count_items(state, "voxels", mean_occupied(staged));
}

/// Poses of all scans of the workload from the first; one call is one scan on average.
void odometry_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool,
                    const OdometryKind& kind) {
  double worst_m = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    const std::unique_ptr<Odometry> odometry = kind.make(kind.defaults, pool.size());
    const Pose first_from_map = staged.all.front().frame.map_from_sensor.inverse();
    for (const StagedScan& s : staged.all) {
      const Pose found = odometry->push(s.frame.points).map_from_sensor;
      const Pose truth = first_from_map * s.frame.map_from_sensor;
      worst_m = std::max(worst_m, (found.translation() - truth.translation()).norm());
    }
  }
  state.counters["worst_m"] = worst_m;
  expect(state, worst_m < 2.0);
  count_items(state, "points", mean_points(staged));
}

}  // namespace

std::vector<BenchmarkRow> method_rows() {
  std::vector<BenchmarkRow> rows = {{"pipeline", pipeline_stage, true}};
  for (const MethodKind& kind : methods()) {
    const bool is_pipeline = &kind == &default_method();
    if (is_pipeline || kind.is_twin || (kind.name == "octomap" && !MOSBENCH_WITH_OCTOMAP)) continue;
    rows.push_back({std::string(kind.name),
                    [&kind](benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
                      method_stage(state, staged, pool, kind);
                    },
                    true});
  }
  rows.push_back({"plus_map_update", plus_stage<PlusStage::kHistory>, true});
  rows.push_back({"plus_arrivals", plus_stage<PlusStage::kArrivals>, true});
  rows.push_back({"plus_ground", plus_stage<PlusStage::kGround>, false});
  rows.push_back({"plus_look_back", plus_stage<PlusStage::kLookBack>, true});
  rows.push_back({"plus_prediction", plus_stage<PlusStage::kPrediction>, false});
  rows.push_back({"plus_objects", plus_stage<PlusStage::kObjects>, false});
  for (const OdometryKind& kind : odometries()) {
    rows.push_back({"odometry_" + std::string(kind.name),
                    [&kind](benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
                      odometry_stage(state, staged, pool, kind);
                    },
                    true});
  }
  return rows;
}

}  // namespace mosbench
