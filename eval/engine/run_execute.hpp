#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "eval/engine/run_plan.hpp"

namespace mosbench {

/// What is known of one sequence when the run is over, whether it was segmented now or earlier.
struct SequenceOutcome {
  Result result;
  std::filesystem::path folder;
  bool reused = false;  ///< finished by an earlier run of the same command
};

/// A sequence whose results are not at their place yet, and go unless `put` puts them there.
struct ComputedSequence {
  std::unique_ptr<Claim> claim;
  bool has_labels;
  SequenceOutcome outcome;
};
/// Computes a sequence. Throws DataError.
ComputedSequence compute_sequence(const RunPlan& plan, const PlannedSequence& planned);
/// Puts its results at their place.
SequenceOutcome put(ComputedSequence computed);

/// A run that goes on by one sequence at a time. Tells on stderr what it does.
class RunExecution {
 public:
  /// Holds the folder of the results. Throws UsageError when another run writes to it.
  explicit RunExecution(const RunPlan& plan);

  /// Segments the next sequence, unless it has a result, and writes its folder. Throws DataError;
  /// sequences finished before stay, or where one of them was removed meanwhile.
  void advance();
  const std::vector<SequenceOutcome>& outcomes() const { return outcomes_; }

 private:
  void advance_one();

  const RunPlan& plan_;
  FolderLock lock_;
  std::vector<SequenceOutcome> outcomes_;
};

/// Does all of it. Throws as RunExecution.
std::vector<SequenceOutcome> execute_run(const RunPlan& plan);

}  // namespace mosbench
