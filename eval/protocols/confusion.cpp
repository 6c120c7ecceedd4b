#include "eval/protocols/confusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "datasets/formats/point_range.hpp"

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

/// Rounds the limits to the number type in which the protocol's own program compares.
RangeGate rounded(const RangeGate& limits, Arithmetic arithmetic) {
  if (arithmetic == Arithmetic::kDouble) return limits;
  return {static_cast<double>(static_cast<float>(limits.min_m)),
          static_cast<double>(static_cast<float>(limits.max_m))};
}

/// Returns what the protocol's limits are for.
double limited_m(const Protocol& protocol, const Point& point) {
  if (protocol.range_shape == RangeShape::kDistance) {
    return range_m(point, protocol.range_arithmetic);
  }
  if (std::isnan(point.x + point.y + point.z)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(std::abs(point.x), std::abs(point.y));
}

/// Returns the truth class of a point that is out of range.
TruthClass class_out_of_range(RangeRule rule, TruthClass inside) {
  if (rule == RangeRule::kTruthAndPrediction) return TruthClass::kIgnored;
  return inside == TruthClass::kMoving ? TruthClass::kStatic : inside;
}

PointOutcome outcome_of(TruthClass truth, bool moving) {
  switch (truth) {
    case TruthClass::kStatic:
      return moving ? PointOutcome::kFalsePositive : PointOutcome::kTrueNegative;
    case TruthClass::kMoving:
      return moving ? PointOutcome::kTruePositive : PointOutcome::kFalseNegative;
    case TruthClass::kAlwaysNegative:
      return PointOutcome::kTrueNegative;
    case TruthClass::kIgnored:
      break;
  }
  return moving ? PointOutcome::kIgnoredMoving : PointOutcome::kIgnoredStatic;
}

/// Calls `accept` with the outcome of each point and whether its ids are known, in order.
template <typename Accept>
void judge_points(const Protocol& protocol, std::span<const std::uint32_t> truth,
                  std::span<const std::uint32_t> prediction, std::span<const Point> points,
                  const RangeGate& limits, Accept&& accept) {
  check_sizes(protocol, truth.size(), prediction.size(), points.size());
  const bool gated = protocol.range_rule != RangeRule::kNone;
  if (gated) check_limits(limits);
  const RangeGate gate = rounded(limits, protocol.range_arithmetic);
  const LabelTable truth_classes(protocol.truth);
  const LabelTable prediction_classes(protocol.prediction);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    TruthClass truth_class = truth_classes[truth[i]];
    if (gated && !gate.contains(limited_m(protocol, points[i]))) {
      truth_class = class_out_of_range(protocol.range_rule, truth_class);
    }
    const TruthClass predicted = prediction_classes[prediction[i]];
    const bool moving = predicted == TruthClass::kMoving;
    const bool left_out =
        protocol.counts_known_predictions_only && predicted == TruthClass::kIgnored;
    if (left_out || truth.size() < protocol.min_points) truth_class = TruthClass::kIgnored;
    accept(outcome_of(truth_class, moving),
           truth_classes.is_known(truth[i]) && prediction_classes.is_known(prediction[i]));
  }
}

}  // namespace

bool is_labelled_moving(PointOutcome outcome) {
  return outcome == PointOutcome::kTruePositive || outcome == PointOutcome::kFalsePositive ||
         outcome == PointOutcome::kIgnoredMoving;
}

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
  return range_m(point);
}

Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points,
                     const RangeGate& limits) {
  OutcomeCounts counts{};
  std::uint64_t unknown_ids = 0;
  judge_points(protocol, truth, prediction, points, limits, [&](PointOutcome outcome, bool known) {
    ++counts[static_cast<std::size_t>(outcome)];
    unknown_ids += known ? 0 : 1;
  });
  Confusion confusion = to_confusion(counts);
  confusion.unknown_ids = unknown_ids;
  return confusion;
}

std::vector<PointOutcome> point_outcomes(const Protocol& protocol,
                                         std::span<const std::uint32_t> truth,
                                         std::span<const std::uint32_t> prediction,
                                         std::span<const Point> points, const RangeGate& limits) {
  std::vector<PointOutcome> outcomes;
  outcomes.reserve(truth.size());
  judge_points(protocol, truth, prediction, points, limits,
               [&](PointOutcome outcome, bool) { outcomes.push_back(outcome); });
  return outcomes;
}

Confusion to_confusion(const OutcomeCounts& counts) {
  const auto of = [&counts](PointOutcome outcome) {
    return counts[static_cast<std::size_t>(outcome)];
  };
  return {.tp = of(PointOutcome::kTruePositive),
          .fp = of(PointOutcome::kFalsePositive),
          .fn = of(PointOutcome::kFalseNegative),
          .tn = of(PointOutcome::kTrueNegative),
          .ignored = of(PointOutcome::kIgnoredStatic) + of(PointOutcome::kIgnoredMoving)};
}

}  // namespace mosbench
