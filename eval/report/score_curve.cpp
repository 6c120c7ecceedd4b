#include "eval/report/score_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <mosbench/scan.hpp>
#include <set>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

constexpr int kDroppedBits = 12;
constexpr std::uint32_t kSign = 0x80000000U;

/// Returns a number that rises with the score.
std::uint32_t bucket_of(float score) {
  const auto bits = std::bit_cast<std::uint32_t>(score + 0.0F);  // -0 becomes 0
  return ((bits & kSign) != 0 ? ~bits : bits | kSign) >> kDroppedBits;
}

/// Returns the score of a bucket, cut toward 0.
float score_of(std::uint32_t bucket) {
  constexpr std::uint32_t kDropped = (1U << kDroppedBits) - 1;
  const std::uint32_t ordered = bucket << kDroppedBits;
  return std::bit_cast<float>((ordered & kSign) != 0 ? ordered & ~kSign : ~(ordered | kDropped));
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

void add_sequence(const Result& result, const std::optional<std::filesystem::path>& root,
                  ScoreCounts& counts) {
  const ResultScans scans(result, root);
  if (result.predictions) {
    throw DataError(result.file, "is of mosbench score, which has labels alone",
                    "a run of mosbench run --write scores");
  }
  if (!scans.has_scores()) {
    throw DataError(result.folder() / "scores", "is not there",
                    "scores of points: give the same run command again, with --write scores");
  }
  add_counted_scans(result, scans, counts);
}

std::string metrics_text(const Confusion& counts) {
  return fmt::format("IoU {} %, precision {} %, recall {} %", percent_text(moving_iou(counts)),
                     percent_text(precision(counts)), percent_text(recall(counts)));
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
    sheet.rows.push_back({double{point.threshold}, recall(counts).value(),
                          precision(counts).value(), moving_iou(counts).value(), counts.tp,
                          counts.fp, counts.fn, counts.tn});
  }
  return sheet;
}

nlohmann::ordered_json point_json(const Confusion& counts) {
  nlohmann::ordered_json json;
  for (const Metric metric : kBriefMetrics) {
    json[std::string(row_of(metric).key)] = json_or_null(metric_of(counts, metric));
  }
  return json;
}

nlohmann::ordered_json threshold_json(const CurvePoint& point) {
  nlohmann::ordered_json json = {{"threshold", point.threshold}};
  json.update(point_json(point.counts));
  return json;
}

/// A chart shows no more digits.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

nlohmann::ordered_json curve_json(const ResultSet& run, const ScoreCurve& curve) {
  nlohmann::ordered_json json = provenance_json(run);
  json["scans"] = curve.scans;
  json["average_precision"] = curve.average_precision;
  json["best"] = threshold_json(best_point(curve));
  json["labels"] = point_json(curve.of_labels);
  json["curve"] = nlohmann::ordered_json::array();
  for (const CurvePoint& point : thinned(curve)) json["curve"].push_back(threshold_json(point));
  return json;
}

/// Draws precision over recall, and where the labels of the run are.
LineChart curve_chart(const ResultSet& run, const ScoreCurve& curve) {
  constexpr Colour kThresholds{0, 90, 170}, kOfLabels{200, 60, 0};
  const auto place_of = [](const Confusion& counts) {
    return std::array{100 * recall(counts).value_or(0), 100 * precision(counts).value_or(0)};
  };
  Curve thresholds{"thresholds of the score", kThresholds, {}};
  for (const CurvePoint& point : thinned(curve)) {
    thresholds.points.push_back(place_of(point.counts));
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

ScoreCurve curve_of_run(const std::filesystem::path& path,
                        const std::optional<std::filesystem::path>& dataset_root) {
  ScoreCounts counts;
  for (const Result& result : read_results(path)) add_sequence(result, dataset_root, counts);
  try {
    return counts.curve();
  } catch (const std::domain_error& error) {
    throw DataError(path, error.what(), "scans with truth in which points move");
  }
}

}  // namespace

ScoreCounts::ScoreCounts() : buckets_(std::size_t{1} << (32 - kDroppedBits)) {}

void ScoreCounts::add(const JudgedScan& scan, const ScoreRule& rule) {
  const bool is_gated = rule.protocol->range_rule != RangeRule::kNone;
  const std::vector<std::uint32_t> all_moving(scan.scores.size(), kMovingLabel);
  const std::vector<PointOutcome> outcomes = point_outcomes(
      *rule.protocol, scan.frame.truth.value(), all_moving,
      is_gated ? std::span<const Point>(scan.frame.points) : std::span<const Point>(), rule.range);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    Bucket& bucket = buckets_[bucket_of(scan.scores[i])];
    if (outcomes[i] == PointOutcome::kTruePositive) ++bucket.moving;
    if (outcomes[i] == PointOutcome::kFalsePositive) ++bucket.still;
  }
  OutcomeCounts counts{};
  for (const PointOutcome outcome : scan.outcomes) ++counts[static_cast<std::size_t>(outcome)];
  of_labels_ += to_confusion(counts);
  ++scans_;
}

ScoreCurve ScoreCounts::curve() const {
  Bucket all;
  for (const Bucket& bucket : buckets_) {
    all.moving += bucket.moving;
    all.still += bucket.still;
  }
  if (all.moving == 0) throw std::domain_error("no point moves in the truth");
  ScoreCurve curve{{}, 0.0, of_labels_, scans_};
  Confusion counts{.tp = 0, .fp = 0, .fn = all.moving, .tn = all.still};
  for (std::size_t b = buckets_.size(); b-- > 0;) {
    const Bucket& bucket = buckets_[b];
    if (bucket.moving + bucket.still == 0) continue;
    counts.tp += bucket.moving;
    counts.fn -= bucket.moving;
    counts.fp += bucket.still;
    counts.tn -= bucket.still;
    curve.points.push_back({score_of(static_cast<std::uint32_t>(b)), counts});
    curve.average_precision +=
        ratio(bucket.moving, all.moving) * ratio(counts.tp, counts.tp + counts.fp);
  }
  return curve;
}

const CurvePoint& best_point(const ScoreCurve& curve) {
  return *std::ranges::max_element(
      curve.points, {}, [](const CurvePoint& point) { return moving_iou(point.counts).value(); });
}

std::vector<CurvePoint> thinned(const ScoreCurve& curve, double step) {
  std::vector<CurvePoint> kept;
  for (const CurvePoint& point : curve.points) {
    const auto moved = [&](auto metric) {
      return std::abs(*metric(point.counts) - *metric(kept.back().counts)) >= step;
    };
    const bool is_end = kept.empty() || &point == &curve.points.back();
    if (is_end || moved(precision) || moved(recall)) kept.push_back(point);
  }
  return kept;
}

void add_counted_scans(const Result& result, const ResultScans& scans, ScoreCounts& counts) {
  std::set<std::string> counted;
  for (const ScanRow* scan : counted_scans(result)) counted.insert(scan->stem);
  Progress progress("curve " + result.sequence.text(), counted.size());
  for (std::size_t k = 0; k < scans.sequence().size(); ++k) {
    if (!counted.contains(scans.sequence().stem(k))) continue;
    counts.add(scans.read(k), scans.rule());
    progress.advance();
  }
}

Answer curve_answer(const std::filesystem::path& path,
                    const std::optional<std::filesystem::path>& dataset_root) {
  const ResultSet run = load_result_set(path);
  const ScoreCurve curve = curve_of_run(path, dataset_root);
  const CurvePoint& best = best_point(curve);
  const Confusion& counts = best.counts;
  Sheet sheet = levels_sheet(curve);
  sheet.lead = {headline(run),
                fmt::format("{}, {} of {} counted points move", counted(curve.scans, "scan"),
                            counts.tp + counts.fn, counts.tp + counts.fp + counts.fn + counts.tn),
                fmt::format("average precision {} %", percent_text(curve.average_precision)),
                fmt::format("best threshold {:.6g}: {}", best.threshold, metrics_text(counts)),
                fmt::format("labels of the run: {}", metrics_text(curve.of_labels))};
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
