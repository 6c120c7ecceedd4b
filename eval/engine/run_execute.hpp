#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/disk/folder_lock.hpp"
#include "eval/engine/run_plan.hpp"

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

/// A run that goes on by one sequence at a time. Tells on stderr what it does.
class RunExecution {
 public:
  /// Holds the folder of the results. Throws UsageError when another run writes to it.
  explicit RunExecution(const RunPlan& plan);

  /// Segments the next sequence, unless it has a result, and writes its folder. Throws DataError;
  /// sequences finished before stay.
  void advance();
  const std::vector<SequenceOutcome>& outcomes() const { return outcomes_; }

 private:
  const RunPlan& plan_;
  FolderLock lock_;
  std::vector<SequenceOutcome> outcomes_;
};

/// Does all of it. Throws as RunExecution.
std::vector<SequenceOutcome> execute_run(const RunPlan& plan);

}  // namespace mosbench
