#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/runs/run_plan.hpp"

namespace mosbench {

/// What is known of one sequence when the run is over, whether it was segmented now or earlier.
struct SequenceOutcome {
  SequenceRows rows;
  std::vector<std::string> remarks;
  std::filesystem::path folder;
  bool reused = false;  ///< finished by an earlier run of the same command
};

/// Returns the scans with truth that the protocol's split counts; `position` is that of the
/// sequence in the data set.
std::vector<const ScanRow*> counted_scans(const RunPlan& plan, std::size_t position,
                                          const SequenceRows& rows);

/// Segments the sequences that have no result yet, one after the other, and writes their folders.
/// Tells on stderr what it does. Throws UsageError when another run writes to the same folder,
/// DataError; sequences finished before an error stay.
std::vector<SequenceOutcome> execute_run(const RunPlan& plan);

}  // namespace mosbench
