#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "datasets/sequence/reading_options.hpp"
#include "eval/engine/score_execute.hpp"

namespace mosbench {

/// Where predictions lie and how they are read.
struct PredictionSource {
  std::filesystem::path path;  ///< a folder, or a file for a whole sequence
  PredictionOptions options;
};

/// Returns what "source" of a scored result holds: the folders of this machine in which data set
/// and predictions lie, with the flags by which they were read.
nlohmann::ordered_json source_json(const Dataset& dataset, const ReadingOptions& reading,
                                   const ScoreTask& task, PredictionFormat format);

/// Returns the predictions that a "source" names. Throws UsageError for a word that is not known
/// and nlohmann's exceptions for a missing member.
PredictionSource prediction_source(const nlohmann::ordered_json& source);

}  // namespace mosbench
