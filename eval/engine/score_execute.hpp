#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/result/result_file.hpp"

namespace mosbench {

/// What `score_dataset` is told.
struct ScoreTask {
  std::filesystem::path predictions;
  PredictionOptions options;
  std::vector<ScoreRule> rules;
  std::optional<std::string> split;  ///< only its scans; must be one of the data set
  unsigned threads = 1;
};

/// Scans of one sequence, scored by each rule.
struct SequenceScores {
  std::size_t position;                       ///< in the data set
  std::optional<OpenedPredictions> opened;    ///< nothing when no scan was wanted
  std::vector<std::vector<ScanRow>> by_rule;  ///< as many as rules, each the same scans
};

/// Scores every wanted scan of the data set by every rule, each scan read once, several at a time;
/// the counts do not depend on the number of threads. Throws DataError, also when no scan has
/// truth.
std::vector<SequenceScores> score_dataset(const Dataset& dataset, const ScoreTask& task);

}  // namespace mosbench
