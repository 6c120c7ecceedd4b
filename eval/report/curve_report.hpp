#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "eval/answer/answer.hpp"
#include "eval/report/score_curve.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {

/// A run with the curve of all its counted scans.
struct CurveReport {
  ResultSet run;
  ScoreCurve curve;
};

/// Adds the scores of the scans of a result that the protocol counts. `scans` are those of
/// `result`, with scores. Throws DataError as ResultScans does.
void add_counted_scans(const Result& result, const ResultScans& scans, ScoreCounts& counts);

/// Reads scans, truth, labels and scores of the run again. Throws DataError as ResultScans does,
/// where the run kept no scores, where no scan has truth, and where no point moves.
CurveReport curve_of_run(const std::filesystem::path& path,
                         const std::optional<std::filesystem::path>& dataset_root);

/// Says precision at levels of recall; CSV and the chart have the points of the thinned curve.
Answer curve_answer(const CurveReport& report);
/// Returns what a chart needs, each list by falling threshold: "recall", "precision" and
/// "threshold", "average_precision", "best", "labels".
nlohmann::ordered_json drawn_curve_json(const ScoreCurve& curve);

}  // namespace mosbench
