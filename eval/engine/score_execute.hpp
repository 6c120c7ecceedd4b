#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/sequence.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/score_counts.hpp"
#include "eval/protocols/unsure.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Returns a remark when labels fit the truth clearly better up to 10 scans earlier or later, as
/// when a method numbers them by the newest scan that it has seen; else empty. Compares a dozen of
/// `scans` with the labels around them; those of scans with another number of points are passed
/// over. Throws DataError.
std::string shift_remark(const Sequence& sequence, const std::vector<std::size_t>& scans,
                         const Predictions& labels, const ScoreRule& rule);

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
  UnsureBounds unsure{};                      ///< by the first rule
  std::optional<Result> run{};                ///< that wrote the predictions, where one of ours did
  std::optional<ScoreCounts> confidences{};   ///< by the first rule, where the predictions have any
};

/// Scores every wanted scan of the data set by every rule, each scan read once, several at a time;
/// the counts do not depend on the number of threads. Throws DataError, also when no scan has
/// truth.
std::vector<SequenceScores> score_dataset(const Dataset& dataset, const ScoreTask& task);

}  // namespace mosbench
