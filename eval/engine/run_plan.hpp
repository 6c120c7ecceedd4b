#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/job/job.hpp"
#include "eval/store/store.hpp"

namespace mosbench {

/// How a job is carried out, and where its results go.
struct RunPlace {
  std::optional<std::filesystem::path> out = std::nullopt;
  unsigned threads = hardware_threads();
  bool overwrite = false;
  bool verify = false;  ///< read all input of finished sequences again
  bool scores = false;
  bool objects = false;  ///< with the scores
  /// With the other methods of a list, whose results go to folders of their own below `out`.
  std::shared_ptr<SharedReading> shared = nullptr;
};

/// One sequence of a run: where its results go, and the results when they are there already.
struct PlannedSequence {
  std::size_t position;  ///< in Dataset::sequences
  ResultFolder folder;
  Result asked;       ///< what is known before it runs, and two runs must share
  std::string stamp;  ///< of the input files, see `file_stamp`
  std::optional<Result> finished = std::nullopt;
};

/// Everything decided before the first scan is read.
struct RunPlan {
  Dataset dataset;
  std::string preset;
  RunSettings settings;
  std::filesystem::path out;
  Job job;                                 ///< what is asked
  std::optional<OdometryChoice> odometry;  ///< of the job, with its filter
  std::shared_ptr<SharedReading> shared;   ///< of several methods
  std::vector<PlannedSequence> sequences;
  std::vector<std::string> notes;  ///< choices made for the user, plain sentences
};

/// Opens the data set and settles what the job leaves to it: a plan without sequences. Throws
/// UsageError and DataError.
RunPlan open_job(const Job& job, unsigned threads,
                 const std::shared_ptr<SharedReading>& shared = nullptr);

/// A method that looks from one place was asked for several LiDARs.
class RefusedRig : public UsageError {
 public:
  using UsageError::UsageError;
};

/// The same, and looks at what earlier runs left. Writes nothing. Throws UsageError and DataError.
RunPlan plan_run(const Job& job, const RunPlace& place);

/// What is known of a sequence's result before it is computed.
Result asked_result(const RunPlan& plan, std::size_t position);

}  // namespace mosbench
