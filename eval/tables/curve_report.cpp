#include "eval/tables/curve_report.hpp"

#include <fmt/format.h>

#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

std::string metrics_text(const Confusion& counts) {
  std::string text;
  for (const MetricRow& metric : kMetrics) {
    const auto value = metric_of(counts, static_cast<Metric>(&metric - kMetrics.data()));
    text += fmt::format("{}{} {} %", text.empty() ? "" : ", ", metric.title, percent_text(value));
  }
  return text;
}

nlohmann::ordered_json point_json(const Confusion& counts) {
  nlohmann::ordered_json json;
  for (const Metric metric : kBriefMetrics) {
    json[std::string(row_of(metric).key)] = json_or_null(metric_of(counts, metric));
  }
  return json;
}

}  // namespace

std::vector<std::string> curve_lines(const ScoreCurve& curve) {
  const CurvePoint& best = best_point(curve);
  std::vector<std::string> lines = {
      fmt::format("average precision {} %, of the points of {}",
                  percent_text(curve.average_precision), counted(curve.scans, "scan")),
      fmt::format("own threshold: {}", metrics_text(curve.of_labels)),
      fmt::format("best threshold {:.6g}: {} (best on the same data: optimistic)", best.threshold,
                  metrics_text(best.counts))};
  if (moving_iou(curve.of_labels) > moving_iou(best.counts)) {
    lines.emplace_back(
        "its own may be better: a threshold per scan, or more than the score decides its labels");
  }
  return lines;
}

nlohmann::ordered_json threshold_json(const CurvePoint& point) {
  nlohmann::ordered_json json = {{"threshold", point.threshold}};
  json.update(point_json(point.counts));
  return json;
}

nlohmann::ordered_json curve_summary_json(const ScoreCurve& curve) {
  return {{"scans", curve.scans},
          {"average_precision", curve.average_precision},
          {"best", threshold_json(best_point(curve))},
          {"labels", point_json(curve.of_labels)}};
}

}  // namespace mosbench
