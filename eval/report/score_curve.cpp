#include "eval/report/score_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mosbench/scan.hpp>
#include <set>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/tables/curve_report.hpp"

namespace mosbench {
namespace {

void add_sequence(const Result& result, const std::optional<std::filesystem::path>& root,
                  ScoreCounts& counts) {
  const ResultScans scans(result, root);
  if (!scans.has_scores()) {
    if (result.predictions) {
      throw DataError(result.file, "is of mosbench score of labels alone",
                      "predictions that are confidences, or a run of mosbench run --write scores");
    }
    throw DataError(result.folder() / "scores", "is not there",
                    "scores of points: give the same run command again, with --write scores");
  }
  add_counted_scans(result, scans, counts);
}

/// Precision at levels of recall, of the first point that reaches each.
Sheet levels_sheet(const ScoreCurve& curve) {
  Sheet sheet{.columns = {{"recall % from"},
                          {"score from"},
                          {"precision", Unit::kPercent},
                          {"IoU", Unit::kPercent}}};
  for (int tenth = 1; tenth <= 10; ++tenth) {
    const auto point = std::ranges::find_if(curve.points, [&](const CurvePoint& each) {
      return recall(each.counts).value() >= 0.1 * tenth - 1e-12;
    });
    if (point == curve.points.end()) break;
    sheet.rows.push_back({10.0 * tenth, point->threshold, or_undefined(precision(point->counts)),
                          or_undefined(moving_iou(point->counts))});
  }
  return sheet;
}

/// A row per point of the thinned curve.
Sheet records_of(const ScoreCurve& curve) {
  Sheet sheet;
  for (const char* name : {"threshold", "recall", "precision", "iou", "tp", "fp", "fn", "tn"}) {
    sheet.columns.push_back({name});
  }
  for (const CurvePoint& point : thinned(curve)) {
    const Confusion& counts = point.counts;
    sheet.rows.push_back({point.threshold, recall(counts).value(), precision(counts).value(),
                          moving_iou(counts).value(), counts.tp, counts.fp, counts.fn, counts.tn});
  }
  return sheet;
}

/// A chart shows no more digits.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

nlohmann::ordered_json curve_json(const ResultSet& run, const ScoreCurve& curve) {
  nlohmann::ordered_json json = provenance_json(run);
  json.update(curve_summary_json(curve));
  json["curve"] = nlohmann::ordered_json::array();
  for (const CurvePoint& point : thinned(curve)) json["curve"].push_back(threshold_json(point));
  return json;
}

/// Draws the steps of precision over recall, and where the labels of the run are.
LineChart curve_chart(const ResultSet& run, const ScoreCurve& curve) {
  constexpr Colour kThresholds{0, 90, 170}, kOfLabels{200, 60, 0};
  const auto place_of = [](const Confusion& counts) {
    return std::array{100 * recall(counts).value_or(0), 100 * precision(counts).value_or(0)};
  };
  Curve thresholds{"thresholds of the score", kThresholds, {}};
  for (const CurveCorner& corner : corners(curve)) {
    thresholds.points.push_back({100 * corner.recall, 100 * corner.precision});
  }
  const Curve labels{"labels of the run", kOfLabels, {place_of(curve.of_labels)}};
  return {.title = fmt::format("{}, average precision {} %{}", run.front().method,
                               percent_text(curve.average_precision),
                               run.front().is_simulated() ? " (simulated)" : ""),
          .x_label = "recall %",
          .y_label = "precision %",
          .equal_scales = true,
          .curves = {thresholds, labels},
          .limits = std::array{0.0, 100.0}};
}

Confusion counts_of(const std::vector<PointOutcome>& outcomes) {
  OutcomeCounts counts{};
  for (const PointOutcome outcome : outcomes) ++counts[static_cast<std::size_t>(outcome)];
  return to_confusion(counts);
}

void add_scan(const JudgedScan& scan, const ScoreRule& rule, ScoreCounts& counts) {
  const bool is_gated = rule.protocol->range_rule != RangeRule::kNone;
  const std::vector<double> scores(scan.scores.begin(), scan.scores.end());
  counts.add(
      {.truth = scan.frame.truth.value(),
       .scores = scores,
       .points = is_gated ? std::span<const Point>(scan.frame.points) : std::span<const Point>(),
       .of_labels = counts_of(scan.outcomes)},
      rule);
}

}  // namespace

void add_counted_scans(const Result& result, const ResultScans& scans, ScoreCounts& counts) {
  std::set<std::string> counted;
  for (const ScanRow* scan : counted_scans(result)) counted.insert(scan->stem);
  Progress progress("curve " + result.sequence.text(), counted.size());
  for (std::size_t k = 0; k < scans.sequence().size(); ++k) {
    if (!counted.contains(scans.sequence().stem(k))) continue;
    add_scan(scans.read(k), scans.rule(), counts);
    progress.advance();
  }
}

std::optional<ScoreCurve> curve_of_results(std::span<const Result> results,
                                           const std::optional<std::filesystem::path>& root) {
  ScoreCounts counts;
  for (const Result& result : results) add_sequence(result, root, counts);
  return counts.curve();
}

Answer curve_answer(const ResultSet& run,
                    const std::optional<std::filesystem::path>& dataset_root) {
  const std::optional<ScoreCurve> found = curve_of_results(run.sequences, dataset_root);
  if (!found) {
    throw DataError(run.path, "no point moves in the truth",
                    "scans with truth in which points move");
  }
  const ScoreCurve& curve = *found;
  const Confusion& counts = curve.points.back().counts;
  Sheet sheet = levels_sheet(curve);
  sheet.lead = {headline(run), fmt::format("{} of {} counted points move", counts.tp + counts.fn,
                                           counts.points())};
  for (std::string& line : curve_lines(curve)) sheet.lead.push_back(std::move(line));
  if (curve.points.size() <= 2) {  // of a method that gives a point 1 or 0
    sheet.notes.push_back(fmt::format("the scores take {}: the method says no more than its labels",
                                      counted(curve.points.size(), "value")));
  }
  return {.standing = standing_of(run),
          .sheets = {std::move(sheet)},
          .records = records_of(curve),
          .json = json_text(curve_json(run, curve)),
          .charts = {curve_chart(run, curve)}};
}

nlohmann::ordered_json drawn_curve_json(const ScoreCurve& curve) {
  constexpr double kStep = 4e-3;  // a pixel or two
  nlohmann::ordered_json json = curve_summary_json(curve);
  for (const CurveCorner& corner : corners(curve, kStep)) {
    json["recall"].push_back(rounded(corner.recall));
    json["precision"].push_back(rounded(corner.precision));
    json["threshold"].push_back(
        std::strtod(fmt::format("{:.4g}", corner.threshold).c_str(), nullptr));
  }
  return json;
}

}  // namespace mosbench
