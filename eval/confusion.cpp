#include "eval/confusion.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace mosbench {
namespace {

void check_sizes(const Protocol& protocol, std::size_t truth, std::size_t prediction,
                 std::size_t points) {
  if (prediction != truth) {
    throw std::invalid_argument("prediction: " + std::to_string(prediction) +
                                " labels, expected one per truth label, " + std::to_string(truth));
  }
  const bool needed = protocol.range_rule != RangeRule::kNone;
  if (points != truth && (needed || points != 0)) {
    throw std::invalid_argument("points: " + std::to_string(points) +
                                " points, expected one per truth label, " + std::to_string(truth));
  }
}

void check_limits(const RangeGate& limits) {
  const bool is_interval = std::isfinite(limits.min_m) && !std::isnan(limits.max_m) &&
                           (limits.max_m <= 0.0 || limits.min_m <= limits.max_m);
  if (!is_interval) {
    throw std::invalid_argument("range limits: " + std::to_string(limits.min_m) + " to " +
                                std::to_string(limits.max_m) + " m, expected min <= max");
  }
}

/// The limits in the number type in which the program compares.
RangeGate rounded(const RangeGate& limits, Arithmetic arithmetic) {
  if (arithmetic == Arithmetic::kDouble) return limits;
  return {static_cast<double>(static_cast<float>(limits.min_m)),
          static_cast<double>(static_cast<float>(limits.max_m))};
}

/// What the truth class turns into when the point is out of range.
TruthClass class_out_of_range(RangeRule rule, TruthClass inside) {
  if (rule == RangeRule::kTruthAndPrediction) return TruthClass::kIgnored;
  return inside == TruthClass::kMoving ? TruthClass::kStatic : inside;
}

/// Points per truth class, without and with a moving prediction.
using Tally = std::array<std::array<std::uint64_t, 2>, 4>;

Confusion to_confusion(const Tally& tally, std::uint64_t unknown_ids) {
  const auto of = [&tally](TruthClass truth) { return tally[static_cast<std::size_t>(truth)]; };
  const auto [ignored_static, ignored_moving] = of(TruthClass::kIgnored);
  const auto [true_negatives, false_positives] = of(TruthClass::kStatic);
  const auto [false_negatives, true_positives] = of(TruthClass::kMoving);
  const auto [negative_static, negative_moving] = of(TruthClass::kAlwaysNegative);
  return {.tp = true_positives,
          .fp = false_positives,
          .fn = false_negatives,
          .tn = true_negatives + negative_static + negative_moving,
          .ignored = ignored_static + ignored_moving,
          .unknown_ids = unknown_ids};
}

}  // namespace

Confusion& Confusion::operator+=(const Confusion& other) {
  tp += other.tp;
  fp += other.fp;
  fn += other.fn;
  tn += other.tn;
  ignored += other.ignored;
  unknown_ids += other.unknown_ids;
  return *this;
}

double range_m(const Point& point, Arithmetic arithmetic) {
  if (arithmetic == Arithmetic::kFloat) {
    const float squared = point.x * point.x + point.y * point.y + point.z * point.z;
    return static_cast<double>(std::sqrt(squared));
  }
  const double x = static_cast<double>(point.x);
  const double y = static_cast<double>(point.y);
  const double z = static_cast<double>(point.z);
  return std::sqrt(x * x + y * y + z * z);
}

Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points,
                     const RangeGate& limits) {
  check_sizes(protocol, truth.size(), prediction.size(), points.size());
  const bool gated = protocol.range_rule != RangeRule::kNone;
  if (gated) check_limits(limits);
  const RangeGate gate = rounded(limits, protocol.range_arithmetic);
  const LabelTable truth_classes(protocol.truth);
  const LabelTable prediction_classes(protocol.prediction);
  Tally tally{};
  std::uint64_t unknown_ids = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    TruthClass truth_class = truth_classes[truth[i]];
    if (gated && !gate.contains(range_m(points[i], protocol.range_arithmetic))) {
      truth_class = class_out_of_range(protocol.range_rule, truth_class);
    }
    const bool moving = prediction_classes[prediction[i]] == TruthClass::kMoving;
    ++tally[static_cast<std::size_t>(truth_class)][moving ? 1 : 0];
    const bool known =
        truth_classes.is_known(truth[i]) && prediction_classes.is_known(prediction[i]);
    unknown_ids += known ? 0 : 1;
  }
  return to_confusion(tally, unknown_ids);
}

Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points) {
  return score_scan(protocol, truth, prediction, points, protocol.default_range);
}

}  // namespace mosbench
