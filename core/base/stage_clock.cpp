#include "core/base/stage_clock.hpp"

#include <time.h>

namespace mosbench {

double process_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

StageClock::StageClock(const StageRecord& record, std::string_view stage)
    : record_(record),
      time_{stage, std::chrono::steady_clock::now(), 0, record.cpu_times ? process_cpu_ms() : 0} {}

StageClock::~StageClock() {
  const auto life = std::chrono::steady_clock::now() - time_.start;
  time_.wall_ms = std::chrono::duration<double, std::milli>(life).count();
  if (record_.cpu_times) time_.cpu_ms = process_cpu_ms() - time_.cpu_ms;
  record_.stages.push_back(time_);
}

}  // namespace mosbench
