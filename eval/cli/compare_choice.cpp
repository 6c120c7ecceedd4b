#include <fmt/format.h>

#include <set>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/compare_kinds.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

/// Returns the folder with the results of the method; nothing where there are none.
std::optional<std::filesystem::path> folder_of_method(const std::filesystem::path& place,
                                                      const std::string& method) {
  std::set<std::filesystem::path> folders;
  for (const ResultSet& run : accepted_runs(place)) {
    for (const Result& result : run.sequences) {
      const bool is_it = result.kind == method || lower_case(result.method) == lower_case(method);
      if (is_it) folders.insert(folder_of_run(result.folder(), result.sequence));
    }
  }
  if (folders.size() > 1) {
    throw DataError(place, fmt::format("holds results of {} in {} folders", method, folders.size()),
                    "results of the method in one folder");
  }
  return folders.empty() ? std::nullopt : std::optional(*folders.begin());
}

}  // namespace

void choose_method(CompareFlags& options) {
  if (options.method.empty()) return;
  const auto newer = folder_of_method(options.newer, options.method);
  if (!newer) throw DataError(options.newer, "holds no results of " + options.method, "some");
  const auto before = folder_of_method(options.baseline, options.method);
  const std::filesystem::path within = newer->lexically_relative(options.newer);
  if (before || within != ".") options.baseline = before.value_or(options.baseline / within);
  options.newer = *newer;
}

bool is_chosen(const CompareFlags& options, const std::string& sequence) {
  return options.sequences.empty() ||
         std::ranges::find(options.sequences, sequence) != options.sequences.end();
}

ResultSet chosen_run(const CompareFlags& options, const std::filesystem::path& folder) {
  return only(load_result_set(folder), options.sequences);
}

void check_shares_scans(const PairedRuns& paired, const CompareFlags& options) {
  if (!paired.scans.empty()) return;
  throw DataError(options.newer, "shares no counted scan with " + options.baseline.string(),
                  "results over the same scans");
}

GateResult judged(const CompareFlags& options, const ResultSet& baseline, const ResultSet& newer,
                  const PairedRuns& paired) {
  const GateRule rule = options.statistical ? GateRule::kStatistical : GateRule::kMaxDrop;
  GateResult result =
      judge(paired, *baseline.front().protocol,
            {options.max_drop_points / 100.0, rule, options.max_added_false_positives});
  const CostLimits& limits = options.max_cost;
  result.costs = check_costs(baseline, newer, limits);
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const bool is_known = std::ranges::any_of(
        result.costs, [&](const CostCheck& cost) { return cost.kind == &kCostKinds[k]; });
    if (!limits[k] || is_known) continue;
    throw DataError(
        options.baseline,
        fmt::format("or {} does not tell its {}", options.newer.string(), kCostKinds[k].title),
        "results of a run by this version, or no --max-cost");
  }
  return result;
}

}  // namespace mosbench
