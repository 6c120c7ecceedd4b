#pragma once

#include <mosbench/method.hpp>
#include <string_view>
#include <vector>

namespace mosbench {

/// CPU time that the process has used so far in all its threads.
double process_cpu_ms();

/// Where the times of a scan's stages go.
struct StageRecord {
  std::vector<StageTime>& stages;
  bool cpu_times;  ///< reading that clock costs a microsecond per stage
};

/// Appends the time of its life as one run of a stage.
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
