#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "datasets/doctor/convention_scores.hpp"
#include "datasets/doctor/pose_findings.hpp"

namespace mosbench {
namespace {

constexpr int kMostRowsLost = 4;
/// A shift over fewer scans at an end says nothing.
constexpr std::size_t kFewestScans = 6;
/// Lost scans explain the motions when they leave at most this share of the deviation.
constexpr double kLeftShare = 0.8;

/// Shifts of the rows before a scan and from it on.
struct RowSplit {
  std::size_t scan = 0;
  int rows_before = 0, rows_after = 0;
  double gain = 0.0;
};

bool is_across(const ScanPair& pair, std::size_t scan) {
  return pair.earlier < scan && pair.later >= scan;
}

/// What rows that are shifted by some number gain over the given poses, by the scans of each pair.
class ShiftGains {
 public:
  ShiftGains(const PoseEvidence& evidence, int rows) {
    PoseConvention shifted{"", "", evidence.given};
    shifted.rows_later = rows;
    for (const MeasuredMotion& pair : evidence.pairs) {
      const auto claimed = shifted.motion(pair.pair);
      if (!claimed) continue;
      pairs_.emplace_back(pair.pair, evidence.unlikeliness(pair, evidence.given_motion(pair)) -
                                         evidence.unlikeliness(pair, *claimed));
    }
  }

  double before(std::size_t scan) const {
    return sum([scan](const ScanPair& pair) { return pair.later < scan; });
  }
  double from(std::size_t scan) const {
    return sum([scan](const ScanPair& pair) { return pair.earlier >= scan; });
  }

 private:
  template <typename Counts>
  double sum(Counts&& counts) const {
    double gain = 0.0;
    for (const auto& [pair, pair_gain] : pairs_) gain += counts(pair) ? pair_gain : 0.0;
    return gain;
  }

  std::vector<std::pair<ScanPair, double>> pairs_;
};

/// Returns the split that gains most.
RowSplit best_split(const PoseEvidence& evidence) {
  std::map<int, ShiftGains> gains;
  for (int rows = -kMostRowsLost; rows <= kMostRowsLost; ++rows) {
    gains.emplace(rows, ShiftGains(evidence, rows));
  }
  RowSplit best;
  for (const MeasuredMotion& pair : evidence.pairs) {
    const std::size_t scan = pair.pair.later;
    if (!pair.consecutive() || scan < kFewestScans || scan + kFewestScans > evidence.given.size()) {
      continue;
    }
    std::map<int, double> after;
    for (const auto& [rows, of_rows] : gains) after[rows] = of_rows.from(scan);
    for (const auto& [rows_before, of_rows] : gains) {
      const double gain_before = of_rows.before(scan);
      for (const auto& [rows_after, gain_after] : after) {
        // Poses were right before the loss, or are after it.
        if ((rows_before == 0) == (rows_after == 0)) continue;
        if (gain_before + gain_after <= best.gain) continue;
        best = {scan, rows_before, rows_after, gain_before + gain_after};
      }
    }
  }
  return best;
}

/// Returns whether most motions fit when the rows are shifted so, and far better than as given:
/// poses of another way fit nowhere, though some rows fit less badly.
bool fits(const PoseEvidence& evidence, const RowSplit& split) {
  PoseConvention before{"", "", evidence.given}, after = before;
  before.rows_later = split.rows_before;
  after.rows_later = split.rows_after;
  const auto claimed = [&](const MeasuredMotion& pair) -> std::optional<Pose> {
    if (is_across(pair.pair, split.scan)) return std::nullopt;
    return (pair.pair.later < split.scan ? before : after).motion(pair.pair);
  };
  std::vector<double> misfits;
  for (const MeasuredMotion& pair : evidence.pairs) {
    if (const auto motion = claimed(pair)) misfits.push_back(pair.unsound(*motion).both());
  }
  if (misfits.empty() || median(std::move(misfits)) >= kFitting) return false;
  const double given = evidence.unsound([&](const MeasuredMotion& pair) {
    return claimed(pair) ? std::optional(evidence.given_motion(pair)) : std::nullopt;
  });
  return evidence.unsound(claimed) < kLeftShare * given;
}

}  // namespace

std::optional<LostScan> lost_scan(const PoseEvidence& evidence, double best_gain) {
  const RowSplit split = best_split(evidence);
  if (split.gain < best_gain + kLeastGain || !fits(evidence, split)) return std::nullopt;
  const int lost = split.rows_after - split.rows_before;
  const auto rows = static_cast<std::size_t>(std::abs(lost));
  return LostScan{
      fmt::format("from about scan {} on the poses are {} {} {} than before: expected one pose per "
                  "scan ({} there?)",
                  evidence.stems[split.scan], rows, rows == 1 ? "row" : "rows",
                  lost > 0 ? "later" : "earlier", lost > 0 ? "was a scan lost" : "was a pose lost"),
      rows};
}

}  // namespace mosbench
