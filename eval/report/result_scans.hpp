#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/results/result_file.hpp"
#include "eval/runs/score_execute.hpp"

namespace mosbench {

/// A folder of `mosbench run` with its result.json.
struct FoundResult {
  std::filesystem::path folder;
  SequenceName name;  ///< of the sequence
  ResultFile file;
};

/// Finds the results at and below `path`, ordered by path. Throws DataError when there are none.
std::vector<FoundResult> find_results(const std::filesystem::path& path);

/// Whether the labels of a run are next to its result.json.
bool has_labels(const FoundResult& result);

/// One scan with the outcome of each point.
struct JudgedScan {
  Frame frame;
  std::vector<PointOutcome> outcomes;  ///< kIgnoredStatic or kIgnoredMoving without truth
  std::vector<float> scores;           ///< of the method, empty unless the run kept them
};

/// The scans of a result: points and truth from the data set, labels from the result's folder.
class ResultScans {
 public:
  /// Opens the data set at `dataset_root`, by default where the run read it, with the run's reading
  /// options. Throws DataError when it is missing or not what the run read, when the result has no
  /// labels next to it, and when result.json does not say how it was scored.
  ResultScans(const FoundResult& result, const std::optional<std::filesystem::path>& dataset_root);

  const Dataset& dataset() const { return dataset_; }
  const std::filesystem::path& label_folder() const { return label_folder_; }
  /// Protocol and range of the run.
  const ScoreRule& rule() const { return rule_; }
  const Sequence& sequence() const { return *dataset_.sequences.front(); }
  /// Whether the run kept scores.
  bool has_scores() const { return has_scores_; }
  /// Throws DataError when the labels do not give the counts of result.json.
  JudgedScan read(std::size_t scan_index) const;

 private:
  const FoundResult& result_;
  Dataset dataset_;
  ScoreRule rule_;
  std::filesystem::path label_folder_;
  bool has_scores_;
};

}  // namespace mosbench
