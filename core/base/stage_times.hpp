#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace mosbench {

/// The stages in the order in which a scan passes them.
enum class Stage : std::size_t {
  kVoxelize,
  kRaycast,
  kMapUpdate,
  kEvict,
  kConvolution,
  kMedian,
  kWindow,
  kOtsu,
  kDynamicRegion,
  kLabels,
};
inline constexpr std::array<std::string_view, 10> kStageNames = {
    "voxelize", "raycast", "map_update", "evict",          "convolution",
    "median",   "window",  "otsu",       "dynamic_region", "labels"};

/// Wall milliseconds per stage of one scan.
using StageTimes = std::array<double, kStageNames.size()>;

/// One run of a stage.
struct StageEvent {
  Stage stage;
  std::chrono::steady_clock::time_point start;
  double wall_ms;
  double cpu_ms;  ///< of the whole process, all threads, also while they watch for work
};

/// CPU time that the process has used so far in all its threads.
double process_cpu_ms();

}  // namespace mosbench
