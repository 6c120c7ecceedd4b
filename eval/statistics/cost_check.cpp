#include "eval/statistics/cost_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// The costs of sequences together: CPU as milliseconds of all scans.
struct CostSum {
  std::array<double, kCostKinds.size()> values{};
  bool has_calibration = true;

  void add(const RunCost& cost, std::size_t scans, double speed) {
    values[0] += speed * cost.core_ms_per_scan * static_cast<double>(scans);
    values[1] = std::max(values[1], cost.most_resident_mib);
    values[2] += static_cast<double>(cost.bytes_written);
  }
};

}  // namespace

CostLimits cost_limits(std::string_view flag, const std::string& text) {
  CostLimits limits;
  for (const std::string_view part : split_at_commas(text)) {
    if (part.empty()) continue;
    const std::size_t equals = std::min(part.find('='), part.size());
    const auto kind = std::ranges::find(kCostKinds, part.substr(0, equals), &CostKind::key);
    const bool has_value = equals < part.size();
    const double percent = has_value ? parse_double(part.substr(equals + 1)).value_or(-1.0) : -1.0;
    if (kind == kCostKinds.end() || percent < 0.0) {
      throw UsageError(
          fmt::format("{} {}: is no limit, expected cpu, memory or bytes, and the "
                      "percents by which it may grow, as in cpu=10,memory=20",
                      flag, part));
    }
    limits[static_cast<std::size_t>(kind - kCostKinds.begin())] = percent / 100.0;
  }
  return limits;
}

bool CostCheck::is_within() const { return newer <= baseline * (1.0 + tolerance()) + 1e-9; }

std::vector<CostCheck> check_costs(const ResultSet& baseline, const ResultSet& newer,
                                   const CostLimits& limits) {
  CostSum before, after;
  double scans = 0.0, other_scans = 0.0;
  for (const Result& first : baseline.sequences) {
    const auto second = std::ranges::find(newer.sequences, first.sequence, &Result::sequence);
    if (second == newer.sequences.end()) continue;
    const std::optional<RunCost> cost = run_cost(first), other = run_cost(*second);
    if (!cost || !other) return {};
    const bool is_calibrated = cost->calibration_ms && other->calibration_ms;
    before.has_calibration = before.has_calibration && is_calibrated;
    before.add(*cost, first.scans.size(), 1.0);
    after.add(*other, second->scans.size(),
              is_calibrated ? *cost->calibration_ms / *other->calibration_ms : 1.0);
    scans += static_cast<double>(first.scans.size());
    other_scans += static_cast<double>(second->scans.size());
  }
  if (scans == 0.0 || other_scans == 0.0) return {};
  before.values[0] /= scans;
  after.values[0] /= other_scans;
  std::vector<CostCheck> checks;
  for (std::size_t k = 0; k < kCostKinds.size(); ++k) {
    // Memory and files grow with the scans.
    const bool is_known =
        before.values[k] > 0.0 && (k > 0 ? scans == other_scans : before.has_calibration);
    if (!is_known) continue;
    checks.push_back({&kCostKinds[k], before.values[k], after.values[k], limits[k]});
  }
  return checks;
}

}  // namespace mosbench
