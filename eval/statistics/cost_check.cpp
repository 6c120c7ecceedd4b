#include "eval/statistics/cost_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// CPU times of shorter runs differ by a third on one machine.
constexpr double kLeastCpu_s = 2.0;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The costs of sequences together: CPU as milliseconds of all scans.
struct CostSum {
  std::array<double, kCostKinds.size()> values{};
  double scans = 0.0;

  void add(const RunCost& cost, std::size_t count) {
    values[0] += cost.core_ms_per_scan.value_or(kUnknown) * static_cast<double>(count);
    values[1] = std::max(values[1], cost.most_resident_mib);
    values[2] += static_cast<double>(cost.bytes_written);
    scans += static_cast<double>(count);
  }
};

/// Returns by what CPU times of `other` become those on the machine of `cost`.
std::optional<double> machine_factor(const RunCost& cost, const RunCost& other) {
  if (cost.machine && cost.machine == other.machine) return 1.0;
  if (!cost.calibration_ms || !other.calibration_ms) return std::nullopt;
  return *cost.calibration_ms / *other.calibration_ms;
}

/// Why the CPU of runs is not judged, one of which took so much; empty where it is.
std::string why_not(double before_ms, double after_ms) {
  if (std::isnan(before_ms + after_ms)) return "measured by an older mosbench";
  const double cpu_ms = std::max(before_ms, after_ms);
  if (cpu_ms >= 1e3 * kLeastCpu_s) return "";
  return fmt::format("too short to judge: {:.1f} s of CPU, expected at least {:g} s", 1e-3 * cpu_ms,
                     kLeastCpu_s);
}

}  // namespace

CostLimits cost_limits(std::string_view flag, const std::string& text) {
  CostLimits limits;
  for (const std::string_view part : split_at_commas(text)) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const auto kind = std::ranges::find(kCostKinds, part.substr(0, equals), &CostKind::key);
    const bool has_value = equals < part.size();
    const double percent = has_value ? parse_double(part.substr(equals + 1)).value_or(-1.0) : -1.0;
    if (kind == kCostKinds.end() || percent < 0.0) {
      throw UsageError(
          fmt::format("{}: '{}' is no limit, expected cpu, memory or bytes, and the "
                      "percents by which it may grow, as in cpu=10,memory=20",
                      flag, part));
    }
    std::optional<double>& limit = limits[static_cast<std::size_t>(kind - kCostKinds.begin())];
    if (limit) throw UsageError(fmt::format("{}: limits {} twice, expected once", flag, kind->key));
    limit = percent / 100.0;
  }
  return limits;
}

bool CostCheck::is_within() const { return newer <= baseline * (1.0 + tolerance()) + 1e-9; }

bool CostCheck::warns() const {
  return limit ? !unjudged.empty() : unjudged.empty() && !is_within();
}

std::vector<CostCheck> check_costs(const ResultSet& baseline, const ResultSet& newer,
                                   const CostLimits& limits) {
  CostSum before, after;
  double cpu_there_ms = 0.0;  // of the new run on the baseline's machine
  bool are_comparable = true;
  std::string others_written;
  for (const Result& first : baseline.sequences) {
    const auto second = std::ranges::find(newer.sequences, first.sequence, &Result::sequence);
    if (second == newer.sequences.end()) continue;
    const std::optional<RunCost> cost = run_cost(first), other = run_cost(*second);
    if (!cost || !other) return {};
    before.add(*cost, first.scans.size());
    after.add(*other, second->scans.size());
    const std::optional<double> factor = machine_factor(*cost, *other);
    are_comparable = are_comparable && factor;
    cpu_there_ms += factor.value_or(1.0) * other->core_ms_per_scan.value_or(kUnknown) *
                    static_cast<double>(second->scans.size());
    const bool are_told = !cost->what_written.empty() && !other->what_written.empty();
    if (are_told && cost->what_written != other->what_written) {
      others_written =
          fmt::format("not compared: {} before, {} now", fmt::join(cost->what_written, ", "),
                      fmt::join(other->what_written, ", "));
    }
  }
  std::vector<CostCheck> checks;
  if (before.scans == 0.0 || after.scans == 0.0) return checks;
  const bool is_unknown = std::isnan(before.values[0] + after.values[0]);
  if (is_unknown || (are_comparable && before.values[0] > 0.0)) {
    checks.push_back({.kind = &kCostKinds[0],
                      .baseline = before.values[0] / before.scans,
                      .newer = cpu_there_ms / after.scans,
                      .limit = limits[0],
                      .unjudged = why_not(before.values[0], after.values[0]),
                      .factor = is_unknown ? 1.0 : cpu_there_ms / after.values[0]});
  }
  for (std::size_t k = 1; k < kCostKinds.size(); ++k) {
    // Memory and files grow with the scans.
    if (before.values[k] <= 0.0 || before.scans != after.scans) continue;
    checks.push_back({&kCostKinds[k], before.values[k], after.values[k], limits[k],
                      k == 2 ? others_written : ""});
  }
  return checks;
}

}  // namespace mosbench
