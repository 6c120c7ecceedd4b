#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/result/result.hpp"
#include "eval/statistics/run_statistics.hpp"

// What `mosbench compare` does with two runs: it judges one, shows what differs, or accepts one.

namespace mosbench {

/// Two runs, and what `mosbench compare` does with them.
struct CompareFlags {
  std::filesystem::path baseline, newer;
  double max_drop_points = 0.5;
  std::optional<double> max_added_false_positives;
  bool statistical = false, even_if = false, quiet = false, allow_stale = false;
  std::string accept;  ///< why; "true" where nothing was said
  std::vector<std::string> by, sequences;
  std::string method;
  CostLimits max_cost;
  std::optional<std::filesystem::path> data;
  std::string dataset = "auto";
  std::size_t top = 10;
  std::filesystem::path out, summary;

  bool shows(std::string_view what) const { return std::ranges::find(by, what) != by.end(); }
};

/// Narrows both folders to the results of the method. A baseline that has none yet gets them where
/// they are in the new ones. Throws DataError.
void choose_method(CompareFlags& options);
bool is_chosen(const CompareFlags& options, const std::string& sequence);
/// Returns the chosen sequences of the run in a folder. Throws DataError where one is not there.
ResultSet chosen_run(const CompareFlags& options, const std::filesystem::path& folder);
/// Throws DataError for runs without a scan in common.
void check_shares_scans(const PairedRuns& paired, const CompareFlags& options);
/// Judges labels and cost by the limits that were asked for. Throws UsageError.
GateResult judged(const CompareFlags& options, const ResultSet& baseline, const ResultSet& newer,
                  const PairedRuns& paired);

/// Shows what the new run changes in each sequence, or on which scans and objects the two disagree.
/// Throws UsageError and DataError.
Answer difference_by(const CompareFlags& options);
/// Makes the new run the baseline and returns what that changes. Throws UsageError and DataError.
Answer accept_newer(const CompareFlags& options);

}  // namespace mosbench
