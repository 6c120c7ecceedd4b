#pragma once

#include <mosbench/method.hpp>
#include <string_view>
#include <vector>

namespace mosbench {

/// Returns the CPU time that all threads of the process have used so far.
double process_cpu_ms();

/// The list that the times of a scan's stages are appended to.
struct StageRecord {
  std::vector<StageTime>& stages;
  bool cpu_times;  ///< reading that clock costs a microsecond per stage
};

/// Measures its own lifetime and appends it as one run of a stage.
class StageClock {
 public:
  StageClock(const StageRecord& record, std::string_view stage);
  ~StageClock();
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  StageRecord record_;
  StageTime time_;
};

/// Runs one stage and returns its value.
template <typename Work>
auto timed(const StageRecord& record, std::string_view stage, Work&& work) {
  const StageClock clock(record, stage);
  return work();
}

}  // namespace mosbench
