#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "eval/answer/answer.hpp"
#include "eval/protocols/score_counts.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// Adds the scores of the scans of a result that the protocol counts. `scans` are those of
/// `result`, with scores. Throws DataError as ResultScans does.
void add_counted_scans(const Result& result, const ResultScans& scans, ScoreCounts& counts);

/// Returns the curve of runs that kept scores, whose scans are read again; null when no point moves
/// in the truth. Throws DataError as ResultScans does, and where a run kept no scores.
std::optional<ScoreCurve> curve_of_results(std::span<const Result> results,
                                           const std::optional<std::filesystem::path>& root);

/// Reads scans, truth, labels and scores of a run again, and says precision at levels of recall;
/// CSV and the chart have the points of the thinned curve. Throws DataError as ResultScans does,
/// where the run kept no scores, where no scan has truth, and where no point moves.
Answer curve_answer(const ResultSet& run, const std::optional<std::filesystem::path>& dataset_root);
/// Returns what a chart needs, each list by falling threshold: "recall", "precision" and
/// "threshold", "average_precision", "best", "labels".
nlohmann::ordered_json drawn_curve_json(const ScoreCurve& curve);

}  // namespace mosbench
