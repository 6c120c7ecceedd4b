#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/layouts/dataset.hpp"
#include "eval/engine/odometry_choice.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/engine/shared_reading.hpp"
#include "eval/store/result_folder.hpp"

namespace mosbench {

/// What the user asked of `mosbench run`, as typed.
struct RunOptions {
  std::filesystem::path input;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  std::optional<std::string> method, preset, variant, protocol, range;
  std::string moving = "now";  ///< or "ever" or "ever:SECONDS"
  std::optional<std::filesystem::path> config_file, out;
  Reading reading = {};
  OdometryOptions odometry;  ///< poses are found by it when a kind is named
  std::vector<std::string> assignments;
  unsigned threads = hardware_threads();
  bool overwrite = false;
  bool verify = false;  ///< read all input of finished sequences again
  bool scores = false;
  /// With the other methods of a list, whose results go to folders of their own below `out`.
  std::shared_ptr<SharedReading> shared = nullptr;
};

/// One sequence of a run: where its results go, and the results when they are there already.
struct PlannedSequence {
  std::size_t position;  ///< in Dataset::sequences
  ResultFolder folder;
  Result asked;       ///< what is known before it runs, and two runs must share
  std::string stamp;  ///< of the input files, see `file_stamp`
  std::optional<Result> finished;
};

/// Everything decided before the first scan is read.
struct RunPlan {
  Dataset dataset;
  std::string preset;
  RunSettings settings;
  std::filesystem::path out;
  std::optional<OdometryChoice> odometry;  ///< finds the poses of every sequence that is run
  Reading reading;                         ///< as the user told
  std::shared_ptr<SharedReading> shared;   ///< as the user's options have it
  std::vector<PlannedSequence> sequences;
  std::vector<std::string> notes;  ///< choices made for the user, plain sentences
};

/// Opens the data set and chooses method, settings (defaults < preset < file < --set): a plan
/// without sequences. Throws UsageError and DataError.
RunPlan plan_method(const RunOptions& options);

/// The same, and looks at what earlier runs left. Writes nothing. Throws UsageError and DataError.
RunPlan plan_run(const RunOptions& options);

/// Returns the rule by which a run on data of this kind is scored, without opening any. Throws
/// UsageError as `plan_method` does.
ScoreRule score_rule(const RunOptions& options, DatasetKind kind);

/// "auto" is nothing. Throws UsageError for a name that is no data set kind.
std::optional<DatasetKind> dataset_kind_option(const std::string& name);

/// What is known of a sequence's result before it is computed.
Result asked_result(const RunPlan& plan, std::size_t position);

/// "MIN,MAX" in metres, MAX -1 for no limit. Throws UsageError, also for a limit that the protocol
/// does not know.
RangeGate range_option(const std::string& text, const Protocol& protocol);

}  // namespace mosbench
