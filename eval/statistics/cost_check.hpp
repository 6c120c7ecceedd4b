#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/result/result.hpp"

namespace mosbench {

/// What a run costs that a gate looks at.
struct CostKind {
  std::string_view key, title;
  double usual_growth;  ///< that passes without a word, a fraction; machines are noisy
};
inline constexpr std::array<CostKind, 3> kCostKinds = {{{"cpu", "CPU ms per scan", 0.3},
                                                        {"memory", "most memory, MiB", 0.2},
                                                        {"bytes", "bytes written", 0.05}}};

/// By how much each kind may grow, a fraction. What nobody limited fails never.
using CostLimits = std::array<std::optional<double>, kCostKinds.size()>;
/// Reads "cpu=10,memory=20", percent. Throws UsageError naming the flag.
CostLimits cost_limits(std::string_view flag, const std::string& text);

/// One kind of cost of two runs.
struct CostCheck {
  const CostKind* kind;
  double baseline, newer;
  std::optional<double> limit;  ///< that was asked for
  std::string unjudged{};       ///< why nobody can tell whether it grew; empty where one can
  double factor = 1.0;          ///< that `newer` contains, from machine to machine
  double growth() const { return newer / baseline - 1.0; }
  double tolerance() const { return limit.value_or(kind->usual_growth); }
  bool is_within() const;
  /// Whether it is within a limit that was asked for; otherwise it is a warning at most.
  bool passed() const { return !limit || !unjudged.empty() || is_within(); }
  bool warns() const;
};

/// Compares what both runs know of the sequences that both have. CPU times are those on the
/// baseline's machine, by the calibrations where it is another one.
std::vector<CostCheck> check_costs(const ResultSet& baseline, const ResultSet& newer,
                                   const CostLimits& limits);

}  // namespace mosbench
