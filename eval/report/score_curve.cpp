#include "eval/report/score_curve.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mosbench/scan.hpp>
#include <stdexcept>

#include "eval/protocols/metrics.hpp"

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

}  // namespace mosbench
