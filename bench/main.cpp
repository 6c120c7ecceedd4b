#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "bench/stage_benchmark.hpp"
#include "eval/result/machine.hpp"

namespace mosbench {

namespace {

bool all_right = true;

void measure(benchmark::State& state, const BenchmarkRow& row, const Workload& workload,
             unsigned threads) {
  // Made once, because making it takes longer than measuring.
  static std::map<const Workload*, StagedScans> staged;
  ThreadPool pool(threads);
  row.benchmark(state, staged.try_emplace(&workload, workload).first->second, pool);
}

void register_all(const std::vector<Workload>& workloads) {
  std::vector<BenchmarkRow> rows = stage_rows();
  const auto append = [&](const std::vector<BenchmarkRow>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  append(method_rows());
#if MOSBENCH_WITH_OCTOMAP
  append(octomap_rows());
#endif
  for (const BenchmarkRow& row : rows) {
    for (const Workload& workload : workloads) {
      for (unsigned threads = 1; threads <= (row.parallel ? 2U : 1U); ++threads) {
        const std::string name =
            row.name + "/" + workload.name + "/threads:" + std::to_string(threads);
        benchmark::RegisterBenchmark(name.c_str(),
                                     [row, &workload, threads](benchmark::State& state) {
                                       measure(state, row, workload, threads);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime()
            ->MeasureProcessCPUTime();
      }
    }
  }
}

/// Removes `--data FOLDER` from the arguments; null when it is not given.
const char* take_recording_folder(std::vector<char*>& arguments) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    if (std::strcmp(arguments[i], "--data") != 0) continue;
    const char* folder = arguments[i + 1];
    const auto at = arguments.begin() + static_cast<std::ptrdiff_t>(i);
    arguments.erase(at, at + 2);
    return folder;
  }
  return nullptr;
}

}  // namespace

void expect(benchmark::State& state, bool right) {
  if (right) return;
  all_right = false;
  state.SkipWithError("wrong answer");
}

/// Exit code: 0, 1 after a wrong answer, 2 for wrong usage.
int run(std::vector<char*> arguments) {
  std::vector<Workload> workloads = simulated_workloads();
  if (const char* folder = take_recording_folder(arguments)) {
    workloads.push_back(recorded_workload(folder));
  }
  // Seconds; an argument of the user comes later and wins. Short, because what runs between two
  // calls takes many times as long.
  std::string min_time = "--benchmark_min_time=0.1";
  arguments.insert(arguments.begin() + std::min<std::ptrdiff_t>(1, std::ssize(arguments)),
                   min_time.data());
  auto count = static_cast<int>(arguments.size());
  keep_freed_memory();  // as the program does
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  register_all(workloads);
  if (benchmark::RunSpecifiedBenchmarks() == 0) return 2;
  return all_right ? 0 : 1;
}

}  // namespace mosbench

int main(int argc, char** argv) {
  try {
    return mosbench::run({argv, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mosbench_bench: %s\n", error.what());
    return 3;
  }
}
