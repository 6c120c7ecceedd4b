#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// The score of the labels if every point with at least this score moved.
struct CurvePoint {
  double threshold;
  Confusion counts;  ///< pooled over all scans
};

/// How precision and recall depend on the threshold of the scores.
struct ScoreCurve {
  std::vector<CurvePoint> points;  ///< by falling threshold, one per score that occurred
  double average_precision = 0;    ///< sum of precision times the rise of recall, 0..1
  Confusion of_labels;             ///< what the method's own labels score, pooled
  std::size_t scans = 0;
};

/// Points of one scan with a score each.
struct ScoredPoints {
  std::span<const std::uint32_t> truth;  ///< raw ids
  std::span<const double> scores;        ///< finite
  std::span<const Point> points;         ///< may be empty as for `score_scan`
  Confusion of_labels;                   ///< what the method's own labels score
};

/// Adds up the scores of many scans. Keeps every score that occurs, once.
class ScoreCounts {
 public:
  void add(const ScoredPoints& scan, const ScoreRule& rule);
  ScoreCounts& operator+=(const ScoreCounts& other);

  /// Returns the curve with a point for each score; null when no point moves in the truth.
  std::optional<ScoreCurve> curve() const;

 private:
  struct Bucket {
    double score;
    std::uint64_t moving, still;
  };
  static void join(std::vector<Bucket>& buckets);
  void join_when_many();

  std::vector<Bucket> buckets_;     ///< in any order
  std::size_t joined_buckets_ = 0;  ///< how many there were after the last `join`
  Confusion of_labels_;
  std::size_t scans_ = 0;
};

/// Returns the point of highest moving IoU, which has the highest F1 too; of equal ones that of the
/// highest threshold.
const CurvePoint& best_point(const ScoreCurve& curve);

/// Returns the points that are needed to draw the curve: neighbours differ by at least `step` in
/// precision or recall, the first and the last are kept.
std::vector<CurvePoint> thinned(const ScoreCurve& curve, double step = 1e-3);

/// A place of the curve in a chart.
struct CurveCorner {
  double recall, precision, threshold;
};

/// Returns the corners of the steps between those points. A precision holds for all recalls above
/// that of the point before, as in the average precision.
std::vector<CurveCorner> corners(const ScoreCurve& curve, double step = 1e-3);

}  // namespace mosbench
