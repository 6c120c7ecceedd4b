#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/answer/answer.hpp"
#include "eval/engine/score_execute.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Counts of one sequence, of a run or of scored predictions.
struct ScoredSequence {
  std::string name;
  std::span<const ScanRow> scans;
  std::optional<double> method_ms_per_scan;
};

/// Row for a sequence, for the part of a sequence that belongs to a split, or for a whole split.
struct SummaryRow {
  enum class Kind { kSequence, kPart, kSplit };
  Kind kind = Kind::kSequence;
  std::string name;
  std::string split;      ///< of a sequence's row: its scans of this split only; empty: all scans
  std::size_t scans = 0;  ///< with and without truth
  Summary summary;        ///< over the scans with truth
  std::optional<double> method_ms_per_scan;
};

/// Summarises sequences together, as the protocol aggregates them.
Summary summary_of(const Protocol& protocol, const std::vector<SequenceCounts>& sequences);

/// Returns a row per sequence, then per split a row for each part that does not cover its sequence
/// and one that aggregates the parts as the protocol says. `sequences` are in the data set's order.
/// Where the protocol's split picks scans, the rows of sequences are over those scans and say so.
std::vector<SummaryRow> summary_rows(const Protocol& protocol, const std::vector<Split>& splits,
                                     const std::vector<ScoredSequence>& sequences);

/// Says them below the rule and which row has the benchmark's number, with a column of milliseconds
/// if a row has some. Without rows there are the lines alone.
Sheet score_sheet(const ScoreRule& rule, const std::vector<Split>& splits,
                  const std::vector<SummaryRow>& rows);

/// Returns a line that names the row with the benchmark's number, or says that none has it; empty
/// when the protocol has no split.
std::string benchmark_remark(const Protocol& protocol, const std::vector<Split>& splits);

/// {"sequences": [...], "parts": [...], "splits": [...]}, undefined metrics as null.
nlohmann::ordered_json rows_json(const std::vector<SummaryRow>& rows);

/// Method whose labels are scored, as named by the user.
struct MethodName {
  std::string name;
  std::string setting;
};

/// Returns one line for each thing recognised about the predictions.
std::vector<std::string> score_remarks(const Dataset& dataset,
                                       const std::vector<SequenceScores>& scores);
/// Says what `mosbench score` found by one rule, the first of the task.
Answer score_answer(const Dataset& dataset, const ScoreTask& task,
                    const std::vector<SequenceScores>& scores, bool with_sequences);

/// Says what `mosbench score --protocol all` found: a row per rule and why it differs.
Answer side_by_side_answer(const Dataset& dataset, const std::vector<ScoreRule>& rules,
                           const std::vector<SequenceScores>& scores);
/// The rows as JSON, which reports show beside the results of a run.
nlohmann::ordered_json protocols_json(const std::vector<ScoreRule>& rules,
                                      const std::vector<SequenceScores>& scores);

/// Throws UsageError where <out>/<sequence> holds anything that `write_scores` did not write.
void check_scored_folders(const Dataset& dataset, const std::filesystem::path& out);

/// Writes <out>/<sequence>/result.json, which `table`, `stats`, `compare` and `report` read as they
/// read those of a run; `reading` is how the data set was opened. Throws DataError, and UsageError
/// for a result there that holds other scores, unless they are to be overwritten.
void write_scores(const Dataset& dataset, const Reading& reading, const ScoreTask& task,
                  const std::optional<MethodName>& method,
                  const std::vector<SequenceScores>& scores, const std::filesystem::path& out,
                  bool overwrite);

}  // namespace mosbench
