#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/engine/run_plan.hpp"

namespace mosbench {

/// Wall and process CPU time, milliseconds.
struct Cost {
  double wall_ms = 0, cpu_ms = 0;
};

/// What one scan cost from reading its file to its labels. Nothing is written or scored.
struct ScanProfile {
  std::string stem;
  std::size_t points = 0;
  std::chrono::steady_clock::time_point start, end;  ///< of reading, and of the method
  Cost read;
  Cost method;  ///< the whole push: all stages and what is between them
  std::vector<StageTime> stages;
  double resident_mib = 0;          ///< of the process
  std::optional<MemoryUse> memory;  ///< of the method; nothing when it does not measure it
};

struct SequenceProfile {
  std::string name;
  unsigned threads = 1;
  std::optional<double> period_ms;  ///< median distance of the stamps; nothing without stamps
  std::vector<ScanProfile> scans;
  std::vector<std::string_view> stages;  ///< in the order in which they first ran
  double program_mib = 0;                ///< the most that a program of the user's held
};

/// Segments the first `most_scans` scans of a sequence, one after the other, and measures. Throws
/// DataError.
SequenceProfile profile_sequence(const Sequence& sequence, const RunSettings& settings,
                                 std::size_t most_scans);

}  // namespace mosbench
