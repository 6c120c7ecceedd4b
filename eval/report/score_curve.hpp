#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// The score of the labels if every point with at least this score, cut as in ScoreCounts, moved.
struct CurvePoint {
  float threshold;
  Confusion counts;  ///< pooled over all scans
};

/// How precision and recall depend on the threshold of the scores.
struct ScoreCurve {
  std::vector<CurvePoint> points;  ///< by falling threshold; at least one
  double average_precision = 0;    ///< sum of precision times the rise of recall, 0..1
  Confusion of_labels;             ///< what the labels of the run score, pooled
  std::size_t scans = 0;
};

/// Adds up the scores of many scans in bounded memory. Scores are cut toward 0 to 12 significant
/// bits: whole numbers up to 4096 and ratios of 1/2000 stay apart.
class ScoreCounts {
 public:
  ScoreCounts();

  /// Adds a scan with truth and scores.
  void add(const JudgedScan& scan, const ScoreRule& rule);

  /// Returns the curve with a point for each score that occurred. Throws std::domain_error when no
  /// point moves in the truth.
  ScoreCurve curve() const;

 private:
  struct Bucket {
    std::uint64_t moving = 0, still = 0;
  };
  std::vector<Bucket> buckets_;  ///< by rising score
  Confusion of_labels_;
  std::size_t scans_ = 0;
};

/// Returns the point of highest moving IoU; of equal ones that of the highest threshold.
const CurvePoint& best_point(const ScoreCurve& curve);

/// Returns the points that are needed to draw the curve: neighbours differ by at least `step` in
/// precision or recall, the first and the last are kept.
std::vector<CurvePoint> thinned(const ScoreCurve& curve, double step = 1e-3);

/// Adds the scores of the scans of a result that the protocol counts. `scans` are those of
/// `result`, with scores. Throws DataError as ResultScans does.
void add_counted_scans(const Result& result, const ResultScans& scans, ScoreCounts& counts);

/// Reads scans, truth, labels and scores of a run again, and says precision at levels of recall;
/// CSV and the chart have the points of the thinned curve. Throws DataError as ResultScans does,
/// where the run kept no scores, where no scan has truth, and where no point moves.
Answer curve_answer(const std::filesystem::path& path,
                    const std::optional<std::filesystem::path>& dataset_root);
/// Returns what a chart needs, each list by falling threshold: "recall", "precision" and
/// "threshold", "average_precision", "best", "labels".
nlohmann::ordered_json drawn_curve_json(const ScoreCurve& curve);

}  // namespace mosbench
