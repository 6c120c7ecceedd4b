#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

#include "bench/staged_scans.hpp"

namespace mosbench {

/// One benchmark, measured on each workload.
struct BenchmarkRow {
  std::string name;
  std::function<void(benchmark::State& state, StagedScans& staged, ThreadPool& pool)> benchmark;
  bool parallel;  ///< measured with one and with two threads
};

/// Stages of the pipeline in its order, and files: each function alone.
std::vector<BenchmarkRow> stage_rows();
/// Whole methods and odometries, and the stages of hmm-mos-plus.
std::vector<BenchmarkRow> method_rows();
/// The map of OctoMap by our rays and by the library's own: in builds with the library.
std::vector<BenchmarkRow> octomap_rows();

/// Shows "<items> per second" and items per call.
inline void count_items(benchmark::State& state, const char* items, std::size_t per_call) {
  const auto calls = static_cast<double>(state.iterations());
  state.counters[std::string(items) + "/s"] =
      benchmark::Counter(static_cast<double>(per_call) * calls, benchmark::Counter::kIsRate);
  state.counters[items] = static_cast<double>(per_call);
}

/// Fails the benchmark, and the program in the end, when it did not compute what it should have.
void expect(benchmark::State& state, bool right);

/// Runs one call of a stage, timed alone while the benchmark's timing is paused. The time to free
/// what the result held before is left out, as in the pipeline.
template <typename Work>
auto timed_call(benchmark::State& state, Work&& work) {
  state.ResumeTiming();
  auto result = work();
  benchmark::DoNotOptimize(result);
  state.PauseTiming();
  return result;
}

/// Runs passes over `scans` scans, each of which is a call of the benchmark. Timing is paused
/// outside the pass's timed_calls, one for each scan.
template <typename Pass>
void measure_passes(benchmark::State& state, std::size_t scans, Pass&& pass) {
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(scans))) {
    state.PauseTiming();
    pass();
    state.ResumeTiming();
  }
}

/// Measures `work` on the measured scans one after another; a call of the benchmark is one scan.
/// `right(scan, result)` returns whether work(scan) has computed what it should.
template <typename Work, typename Right>
void measure_stage(benchmark::State& state, StagedScans& staged, Work&& work, Right&& right) {
  measure_passes(state, staged.measured.size(), [&] {
    for (const StagedScan& scan : staged.measured) {
      staged.run_other_stages();
      const StagedScan inputs = scan;  // just written, as by the stage before
      timed_call(state, [&] { return work(inputs); });
    }
  });
  for (const StagedScan& scan : staged.measured) expect(state, right(scan, work(scan)));
}

/// Returns the mean of a quantity over the measured scans.
template <typename Number>
std::size_t mean_of(const StagedScans& staged, Number&& number) {
  std::size_t sum = 0;
  for (const StagedScan& scan : staged.measured) sum += number(scan);
  return sum / staged.measured.size();
}

inline std::size_t mean_occupied(const StagedScans& staged) {
  return mean_of(staged, [](const StagedScan& scan) { return scan.scan.occupied_count; });
}

inline std::size_t mean_observed(const StagedScans& staged) {
  return mean_of(staged, [](const StagedScan& scan) { return voxels_of(scan.observed); });
}

inline std::size_t mean_points(const StagedScans& staged) {
  return mean_of(staged, [](const StagedScan& scan) { return scan.frame.points.size(); });
}

}  // namespace mosbench
