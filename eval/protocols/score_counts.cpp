#include "eval/protocols/score_counts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

/// From this many on, scores are joined before more are kept.
constexpr std::size_t kManyBuckets = 1U << 20U;

double ratio(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void ScoreCounts::join(std::vector<Bucket>& buckets) {
  std::ranges::sort(buckets, std::greater(), &Bucket::score);
  std::size_t joined = 0;
  for (const Bucket& bucket : buckets) {
    if (joined > 0 && buckets[joined - 1].score == bucket.score) {
      buckets[joined - 1].moving += bucket.moving;
      buckets[joined - 1].still += bucket.still;
    } else {
      buckets[joined++] = bucket;
    }
  }
  buckets.resize(joined);
}

void ScoreCounts::add(const ScoredPoints& scan, const ScoreRule& rule) {
  const std::vector<std::uint32_t> all_moving(scan.truth.size(), kMovingLabel);
  const std::vector<PointOutcome> outcomes =
      point_outcomes(*rule.protocol, scan.truth, all_moving, scan.points, rule.range);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const bool moves = outcomes[i] == PointOutcome::kTruePositive;
    if (!moves && outcomes[i] != PointOutcome::kFalsePositive) continue;
    buckets_.push_back({scan.scores[i], moves ? 1U : 0U, moves ? 0U : 1U});
  }
  of_labels_ += scan.of_labels;
  ++scans_;
  join_when_many();
}

void ScoreCounts::join_when_many() {
  // Twice as many as were left: all joins together cost as much as sorting everything once.
  if (buckets_.size() < std::max(kManyBuckets, 2 * joined_buckets_)) return;
  join(buckets_);
  joined_buckets_ = buckets_.size();
}

ScoreCounts& ScoreCounts::operator+=(const ScoreCounts& other) {
  buckets_.insert(buckets_.end(), other.buckets_.begin(), other.buckets_.end());
  of_labels_ += other.of_labels_;
  scans_ += other.scans_;
  join_when_many();
  return *this;
}

std::optional<ScoreCurve> ScoreCounts::curve() const {
  std::vector<Bucket> buckets = buckets_;
  join(buckets);
  Confusion counts;
  for (const Bucket& bucket : buckets) {
    counts.fn += bucket.moving;
    counts.tn += bucket.still;
  }
  const std::uint64_t moving = counts.fn;
  if (moving == 0) return std::nullopt;
  ScoreCurve curve{{}, 0.0, of_labels_, scans_};
  for (const Bucket& bucket : buckets) {
    counts.tp += bucket.moving;
    counts.fn -= bucket.moving;
    counts.fp += bucket.still;
    counts.tn -= bucket.still;
    curve.points.push_back({bucket.score, counts});
    curve.average_precision +=
        ratio(bucket.moving, moving) * ratio(counts.tp, counts.tp + counts.fp);
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

std::vector<CurveCorner> corners(const ScoreCurve& curve, double step) {
  std::vector<CurveCorner> places;
  double reached = 0.0;
  for (const CurvePoint& point : thinned(curve, step)) {
    const double height = precision(point.counts).value();
    const double recalled = recall(point.counts).value();
    places.push_back({reached, height, point.threshold});
    if (recalled != reached) places.push_back({recalled, height, point.threshold});
    reached = recalled;
  }
  return places;
}

}  // namespace mosbench
