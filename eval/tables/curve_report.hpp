#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/protocols/score_counts.hpp"

namespace mosbench {

/// Says the average precision, what the method's own labels reach and what its best threshold
/// would.
std::vector<std::string> curve_lines(const ScoreCurve& curve);

/// Returns {"threshold", "iou", "precision", "recall"} of a point.
nlohmann::ordered_json threshold_json(const CurvePoint& point);

/// Returns {"scans", "average_precision", "best", "labels"}.
nlohmann::ordered_json curve_summary_json(const ScoreCurve& curve);

}  // namespace mosbench
