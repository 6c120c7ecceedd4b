#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/statistics/bootstrap.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

/// Result of the gate for one sequence, or for all together.
struct GateCheck {
  std::string name;                       ///< of the sequence, or "all"
  std::optional<double> baseline, newer;  ///< IoU, fractions
  Difference difference;                  ///< newer - baseline
  double tolerance = 0.0;                 ///< largest drop that passes, fraction
  bool passed = false;
};

struct GateResult {
  std::vector<GateCheck> checks;  ///< each sequence with counted scans, then all
  bool passed() const;
};

/// Checks that the IoU of the second run is not lower than that of the first by more than the
/// larger of `max_drop` (fraction) and the half-width of the paired 95 % interval. A run whose IoU
/// became undefined fails; one whose IoU was undefined passes.
GateResult judge(const PairedRuns& paired, const Protocol& protocol, double max_drop);

std::string gate_text(const GateResult& result);
nlohmann::ordered_json to_json(const GateResult& result);

}  // namespace mosbench
