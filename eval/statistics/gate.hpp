#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/statistics/intervals.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

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
  bool passed = false;
};

struct GateResult {
  GateRule rule = GateRule::kMaxDrop;
  std::vector<GateCheck> checks;  ///< each sequence with counted scans, then all
  bool passed() const;
};

/// Checks that the IoU of the second run is not lower than that of the first by more than
/// `max_drop` (fraction) or, if larger under GateRule::kStatistical, the half-width of the paired
/// 95 % interval. A run whose IoU became undefined fails; one whose IoU was undefined passes.
GateResult judge(const PairedRuns& paired, const Protocol& protocol, double max_drop,
                 GateRule rule = GateRule::kMaxDrop);

}  // namespace mosbench
