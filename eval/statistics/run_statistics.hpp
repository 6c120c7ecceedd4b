#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/result/result.hpp"
#include "eval/statistics/cost_check.hpp"
#include "eval/statistics/intervals.hpp"

namespace mosbench {

/// Returns how far the scans are apart.
Spacing spacing_of(const ScanGaps& gaps);
Spacing spacing_of(std::span<const Result> sequences);

/// Estimates the metrics of sequences that were scored by one rule, as its protocol aggregates
/// them.
Estimates estimate(std::span<const Result> sequences);

/// One respect in which two runs differ besides their labels.
struct Unlike {
  enum class Kind { kProtocol, kSetting, kScans, kPoses, kInput };
  Kind kind;
  std::string text;  ///< "sequence 00: scan 000017 is only in the first run"
};

/// Two runs with the scans that both have.
struct PairedRuns {
  struct Scan {
    std::string sequence, stem;
    const ScanRow* first;
    const ScanRow* second;
  };
  std::vector<Scan> scans;                    ///< by sequence, in the order of the first run
  std::vector<SequenceCounts> first, second;  ///< their counts, per sequence
  std::vector<Unlike> unlike;                 ///< why a difference may not be due to the labels
  std::string added_settings{};               ///< "p: 3", those that only the second run has
  Spacing spacing = Spacing::kNear;           ///< of the scans
};

/// Pairs by names of sequences and stems of scans. The runs must outlive the result.
PairedRuns pair_runs(const ResultSet& first, const ResultSet& second);

/// Joins the first five texts by "; " and adds the number of the others; empty for none.
std::string unlike_text(const std::vector<Unlike>& unlike);

/// When a drop of the IoU fails.
enum class GateRule {
  kMaxDrop,     ///< when it exceeds `max_drop`: the same scans are counted, so nothing is random
  kStatistical  ///< when it also exceeds the half-width of the paired 95 % interval
};

/// Result of the gate for one sequence, or for all together.
struct GateCheck {
  std::string name;                       ///< of the sequence, or "all"
  std::optional<double> baseline, newer;  ///< IoU, fractions
  Difference difference;                  ///< newer - baseline
  double tolerance = 0.0;                 ///< largest drop that passes, fraction
  /// Points called moving that are not, per scan.
  double baseline_false_positives = 0.0, new_false_positives = 0.0;
  std::optional<double> most_added_false_positives{};  ///< per scan; nothing: any number passes
  bool iou_passed = false;
  bool passed() const;
};

struct GateResult {
  GateRule rule = GateRule::kMaxDrop;
  std::vector<GateCheck> checks;   ///< each sequence with counted scans, then all
  std::vector<CostCheck> costs{};  ///< of all sequences together, where both runs know them
  bool passed() const;
};

/// What a run may lose.
struct GateLimits {
  double max_drop = 0.005;  ///< of the IoU, fraction
  GateRule rule = GateRule::kMaxDrop;
  /// False positives per scan that may be added. By default 10 where nothing moves, so that no IoU
  /// tells, and any number elsewhere.
  std::optional<double> max_added_false_positives{};
};

/// Checks that the IoU of the second run is not lower than that of the first by more than
/// `max_drop` (fraction) or, if larger under GateRule::kStatistical, the half-width of the paired
/// 95 % interval, and that it does not add too many false positives. A run whose IoU became
/// undefined fails; one whose IoU was undefined is judged by the false positives alone.
GateResult judge(const PairedRuns& paired, const Protocol& protocol, const GateLimits& limits);

/// How good a run is, and how fast.
struct IouAndTime {
  std::optional<double> iou, ms_per_scan;
};

/// Returns of each run whether it is on the front: no other is as good and as fast, and better in
/// one of both. A run that lacks a number is not, and beats none.
std::vector<bool> pareto_front(std::span<const IouAndTime> runs);

}  // namespace mosbench
