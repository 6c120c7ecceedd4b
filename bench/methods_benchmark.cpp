#include <map>
#include <optional>
#include <string>

#include "bench/stage_benchmark.hpp"

namespace mosbench {
namespace {

constexpr char kPlus[] = "hmm-mos-plus", kDynablox[] = "dynablox", kLcFreeSpace[] = "lc-free-space",
               kUnderwood[] = "underwood", kDufomap[] = "dufomap", kYoon[] = "yoon";
#if MOSBENCH_WITH_OCTOMAP
constexpr char kOctomap[] = "octomap";
#endif

/// Returns the method with the range limits of the workload.
std::unique_ptr<Method> make(const char* name, const Config& limits, unsigned threads) {
  const MethodKind* kind = find_method(name);
  Settings settings = kind->defaults;
  settings.set("min_range_m", limits.min_range_m);
  settings.set("max_range_m", limits.max_range_m);
  return kind->make(settings, {.threads = threads, .cpu_times = true});
}

/// Measures all scans of the workload from the first; one call is one scan on average. Counters
/// hold the stages' CPU milliseconds per scan, and what the method holds after the last scan in
/// MB. Labels must be those of one thread.
template <const char* name>
void method_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const Config& limits = staged.workload.config;
  std::vector<std::vector<std::uint32_t>> expected;
  const auto once = make(name, limits, 1);
  for (const StagedScan& s : staged.all) {
    expected.push_back(once->push(s.frame.points, s.frame.map_from_sensor).at(0).labels);
  }
  std::map<std::string, double> sum_ms;
  double scans = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(staged.all.size()))) {
    const auto method = make(name, limits, pool.size());
    for (std::size_t k = 0; k < staged.all.size(); ++k) {
      const Frame& frame = staged.all[k].frame;
      const LabelledScan result =
          std::move(method->push(frame.points, frame.map_from_sensor).at(0));
      for (const StageTime& stage : result.stages) sum_ms[std::string(stage.name)] += stage.cpu_ms;
      ++scans;
      expect(state, result.labels == expected[k]);
    }
    if (const std::optional<MemoryUse> use = method->memory()) {
      state.counters["memory_MB"] = static_cast<double>(use->bytes) / 1e6;
    }
  }
  for (const auto& [stage, sum] : sum_ms) state.counters[stage + "_cpu_ms"] = sum / scans;
  count_items(state, "points", mean_points(staged));
}

const RegisterStage plus_stage_of_all(kPlus, method_stage<kPlus>, true);
const RegisterStage dynablox_stage(kDynablox, method_stage<kDynablox>, true);
const RegisterStage lc_free_space_stage(kLcFreeSpace, method_stage<kLcFreeSpace>, true);
const RegisterStage underwood_stage(kUnderwood, method_stage<kUnderwood>, true);
const RegisterStage dufomap_stage(kDufomap, method_stage<kDufomap>, true);
#if MOSBENCH_WITH_OCTOMAP
const RegisterStage octomap_stage(kOctomap, method_stage<kOctomap>, true);
#endif
const RegisterStage yoon_stage(kYoon, method_stage<kYoon>, true);

}  // namespace
}  // namespace mosbench
