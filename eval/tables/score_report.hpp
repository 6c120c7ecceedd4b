#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/engine/score_execute.hpp"
#include "eval/tables/score_table.hpp"

namespace mosbench {

/// Method whose labels are scored, as named by the user.
struct MethodName {
  std::string name;
  std::string setting;
};

/// Returns one line for each thing recognised about the predictions.
std::vector<std::string> score_remarks(const Dataset& dataset,
                                       const std::vector<SequenceScores>& scores);
/// What every format has to show: simulated data and missing predictions.
Standing standing_of(const Dataset& dataset, const std::vector<SequenceScores>& scores);
/// Returns the remarks and what is missing.
std::vector<std::string> all_remarks(const Dataset& dataset,
                                     const std::vector<SequenceScores>& scores);

/// Says what `mosbench score` found by one rule, the first of the task.
Answer score_answer(const Dataset& dataset, const ScoreTask& task,
                    const std::vector<SequenceScores>& scores, bool with_sequences);

/// Says what `mosbench score --protocol all` found: a row per rule and why it differs.
Answer side_by_side_answer(const Dataset& dataset, const std::vector<ScoreRule>& rules,
                           const std::vector<SequenceScores>& scores);
nlohmann::ordered_json side_by_side_json(const Dataset& dataset,
                                         const std::vector<ScoreRule>& rules,
                                         const std::vector<SequenceScores>& scores);

/// Throws UsageError where <out>/<sequence> holds anything that `write_scores` did not write.
void check_scored_folders(const Dataset& dataset, const std::filesystem::path& out);

/// Writes <out>/<sequence>/result.json, which `table`, `stats`, `compare` and `report` read as they
/// read those of a run; `reading` is how the data set was opened. Throws DataError.
void write_scores(const Dataset& dataset, const Reading& reading, const ScoreTask& task,
                  const MethodName& method, const std::vector<SequenceScores>& scores,
                  const std::filesystem::path& out);

/// {"sequences": [...], "parts": [...], "splits": [...]}, undefined metrics as null.
nlohmann::ordered_json rows_json(const std::vector<SummaryRow>& rows);

}  // namespace mosbench
