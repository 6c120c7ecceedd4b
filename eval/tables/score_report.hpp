#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/runs/score_execute.hpp"

namespace mosbench {

/// Whose labels were scored, as the user says.
struct MethodName {
  std::string name;
  std::string setting;
};

/// What was found out about the predictions and what is missing, one line each.
std::vector<std::string> score_remarks(const Dataset& dataset,
                                       const std::vector<SequenceScores>& scores);

/// The answer of `mosbench score` with one rule, the first of the task.
std::string score_text(const Dataset& dataset, const ScoreTask& task,
                       const std::vector<SequenceScores>& scores, bool with_sequences);
std::string score_json(const Dataset& dataset, const ScoreTask& task,
                       const std::vector<SequenceScores>& scores, bool with_sequences);

/// The answer of `mosbench score --protocol all`: a row per rule and why it differs.
std::string side_by_side_text(const Dataset& dataset, const std::vector<ScoreRule>& rules,
                              const std::vector<SequenceScores>& scores);
nlohmann::ordered_json side_by_side_json(const Dataset& dataset,
                                         const std::vector<ScoreRule>& rules,
                                         const std::vector<SequenceScores>& scores);

/// Writes <out>/<sequence>/result.json, which `table`, `stats` and `compare` read like those of a
/// run. Throws DataError.
void write_scores(const Dataset& dataset, const ScoreTask& task, const MethodName& method,
                  const std::vector<SequenceScores>& scores, const std::filesystem::path& out);

}  // namespace mosbench
