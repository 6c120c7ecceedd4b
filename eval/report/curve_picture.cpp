#include <fmt/format.h>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/line_chart.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/report/curve_report.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kCurvePixels = 600;
constexpr Colour kThresholds{0, 90, 170}, kOfLabels{200, 60, 0};

/// Recall and precision in percent.
std::array<double, 2> place_of(const Confusion& counts) {
  return {100 * recall(counts).value_or(0), 100 * precision(counts).value_or(0)};
}

}  // namespace

Picture curve_picture(const CurveReport& report) {
  const ResultSet& run = report.run;
  const std::string title = fmt::format("{}, average precision {} %{}", run.front().method,
                                        percent_text(report.curve.average_precision),
                                        run.front().simulated ? " (simulated)" : "");
  Curve thresholds{"thresholds of the score", kThresholds, {}};
  for (const CurvePoint& point : thinned(report.curve)) {
    thresholds.points.push_back(place_of(point.counts));
  }
  const Curve labels{"labels of the run", kOfLabels, {place_of(report.curve.of_labels)}};
  const LineChart chart{.title = title,
                        .x_label = "recall %",
                        .y_label = "precision %",
                        .equal_scales = true,
                        .curves = {thresholds, labels},
                        .limits = std::array{0.0, 100.0}};
  return line_charts({&chart, 1}, kCurvePixels);
}

}  // namespace mosbench
