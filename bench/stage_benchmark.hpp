#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "bench/staged_scan.hpp"

namespace mosbench {

/// Measures one stage on a scan that nobody else uses.
using StageBenchmark = void (*)(benchmark::State& state, StagedScan& staged, ThreadPool& pool);

struct RegisteredStage {
  std::string name;
  StageBenchmark benchmark;
  bool parallel;  ///< measured with one and with two threads
};

/// All that were registered, in the order of their files.
std::vector<RegisteredStage>& registered_stages();

/// A static object of this type adds a stage to the program.
struct RegisterStage {
  RegisterStage(const char* name, StageBenchmark benchmark, bool parallel) {
    registered_stages().push_back({name, benchmark, parallel});
  }
};

/// Shows "<items> per second" and items per call.
inline void count_items(benchmark::State& state, const char* items, std::size_t per_call) {
  const auto calls = static_cast<double>(state.iterations());
  state.counters[std::string(items) + "/s"] =
      benchmark::Counter(static_cast<double>(per_call) * calls, benchmark::Counter::kIsRate);
  state.counters[items] = static_cast<double>(per_call);
}

/// Fails the benchmark, and the program in the end, when it did not compute what it should have.
void expect(benchmark::State& state, bool right);

}  // namespace mosbench
