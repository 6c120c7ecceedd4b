#include "eval/report/curve_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/csv.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/results/progress.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

void add_sequence(const FoundResult& result, const std::optional<std::filesystem::path>& root,
                  ScoreCounts& counts) {
  const ResultScans scans(result, root);
  if (result.file.content.contains("predictions")) {
    throw DataError(result.folder / "result.json", "is of mosbench score, which has labels alone",
                    "a run of mosbench run --scores");
  }
  if (!scans.has_scores()) {
    throw DataError(result.folder / "scores", "is not there",
                    "scores of points: give the same run command again, with --scores");
  }
  add_counted_scans(result, scans, counts);
}

std::string metrics_text(const Confusion& counts) {
  return fmt::format("IoU {} %, precision {} %, recall {} %", percent_text(moving_iou(counts)),
                     percent_text(precision(counts)), percent_text(recall(counts)));
}

/// Returns the first point that reaches a recall, or null.
const CurvePoint* reaching(const ScoreCurve& curve, double wanted) {
  const auto found = std::ranges::find_if(curve.points, [&](const CurvePoint& point) {
    return recall(point.counts).value() >= wanted - 1e-12;
  });
  return found == curve.points.end() ? nullptr : &*found;
}

std::string levels_text(const ScoreCurve& curve) {
  TextTable table({{"recall % from"}, {"score from"}, {"precision %"}, {"IoU %"}});
  for (int tenth = 1; tenth <= 10; ++tenth) {
    const CurvePoint* point = reaching(curve, 0.1 * tenth);
    if (point == nullptr) continue;
    table.add_row({fmt::format("{}", 10 * tenth), fmt::format("{:.6g}", point->threshold),
                   percent_text(precision(point->counts)),
                   percent_text(moving_iou(point->counts))});
  }
  return table.str();
}

/// A method that gives a point 1 or 0 has nothing to be swept.
std::string few_scores_text(const ScoreCurve& curve) {
  if (curve.points.size() > 2) return "";
  return fmt::format("the scores take {}: the method says no more than its labels\n",
                     counted(curve.points.size(), "value"));
}

nlohmann::ordered_json point_json(const Confusion& counts) {
  return {{"iou", json_or_null(moving_iou(counts))},
          {"precision", json_or_null(precision(counts))},
          {"recall", json_or_null(recall(counts))}};
}

nlohmann::ordered_json threshold_json(const CurvePoint& point) {
  nlohmann::ordered_json json = {{"threshold", point.threshold}};
  json.update(point_json(point.counts));
  return json;
}

/// A chart shows no more digits.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

}  // namespace

void add_counted_scans(const FoundResult& result, const ResultScans& scans, ScoreCounts& counts) {
  const SequenceResult row = sequence_result(result.folder / "result.json", result.file);
  std::set<std::string> counted;
  for (const ScanRow* scan : counted_scans(row)) counted.insert(scan->stem);
  Progress progress("curve " + result.name.text(), counted.size());
  for (std::size_t k = 0; k < scans.sequence().size(); ++k) {
    if (!counted.contains(scans.sequence().stem(k))) continue;
    counts.add(scans.read(k), scans.rule());
    progress.advance();
  }
}

CurveReport curve_of_run(const std::filesystem::path& path,
                         const std::optional<std::filesystem::path>& dataset_root) {
  CurveReport report{load_result_set(path), {}};
  ScoreCounts counts;
  for (const FoundResult& result : find_results(path)) add_sequence(result, dataset_root, counts);
  try {
    report.curve = counts.curve();
  } catch (const std::domain_error& error) {
    throw DataError(path, error.what(), "scans with truth in which points move");
  }
  return report;
}

std::string curve_text(const CurveReport& report) {
  const SequenceResult& first = report.run.front();
  const ScoreCurve& curve = report.curve;
  const CurvePoint& best = best_point(curve);
  const Confusion& counts = best.counts;
  return fmt::format(
      "{}, {}; data set {}, protocol {}{}\n{}, {} of {} counted points move\n\n"
      "average precision {} %\nbest threshold {:.6g}: {}\nlabels of the run: {}\n\n{}{}",
      first.method, first.setting, first.dataset, first.protocol->name,
      first.simulated ? "; SIMULATED" : "", counted(curve.scans, "scan"), counts.tp + counts.fn,
      counts.tp + counts.fp + counts.fn + counts.tn, percent_text(curve.average_precision),
      best.threshold, metrics_text(counts), metrics_text(curve.of_labels), levels_text(curve),
      few_scores_text(curve));
}

std::string curve_csv(const CurveReport& report) {
  std::string csv = "threshold,recall,precision,iou,tp,fp,fn,tn\n";
  for (const CurvePoint& point : thinned(report.curve)) {
    const Confusion& counts = point.counts;
    std::vector<std::string> cells = {fmt::format("{:.9g}", point.threshold)};
    for (const auto& value : {recall(counts), precision(counts), moving_iou(counts)}) {
      cells.push_back(fmt::format("{:.9g}", value.value()));
    }
    for (const std::uint64_t count : {counts.tp, counts.fp, counts.fn, counts.tn}) {
      cells.push_back(fmt::format("{}", count));
    }
    csv += csv_row(cells);
  }
  return csv;
}

nlohmann::ordered_json curve_json(const CurveReport& report) {
  nlohmann::ordered_json json = provenance_json(report.run);
  json["scans"] = report.curve.scans;
  json["average_precision"] = report.curve.average_precision;
  json["best"] = threshold_json(best_point(report.curve));
  json["labels"] = point_json(report.curve.of_labels);
  json["curve"] = nlohmann::ordered_json::array();
  for (const CurvePoint& point : thinned(report.curve)) {
    json["curve"].push_back(threshold_json(point));
  }
  return json;
}

nlohmann::ordered_json drawn_curve_json(const ScoreCurve& curve) {
  constexpr double kStep = 4e-3;  // a pixel or two
  nlohmann::ordered_json json = {{"average_precision", curve.average_precision},
                                 {"best", threshold_json(best_point(curve))},
                                 {"labels", point_json(curve.of_labels)}};
  for (const CurvePoint& point : thinned(curve, kStep)) {
    json["recall"].push_back(rounded(recall(point.counts).value()));
    json["precision"].push_back(rounded(precision(point.counts).value()));
    json["threshold"].push_back(
        std::strtod(fmt::format("{:.4g}", point.threshold).c_str(), nullptr));
  }
  return json;
}

}  // namespace mosbench
