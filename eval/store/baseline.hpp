#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/result/result_set.hpp"

namespace mosbench {

/// Returns the runs in a folder; empty when it does not exist or holds no result.
std::vector<ResultSet> accepted_runs(const std::filesystem::path& folder);

/// Throws UsageError if accepting the results below `newer` as the baseline in `folder` would take
/// some of them away: one folder is the other or above it, or a sequence of the baseline is a link
/// that leads out of it.
void refuse_overlap(const ResultSet& newer, const std::filesystem::path& folder);

/// Writes <folder>/<sequence>/result.json for every sequence of the run, and removes sequences of
/// the folder that the run does not have; other files stay. After a kill at any moment the old or
/// the new baseline is whole. `folder` must be locked. Throws DataError.
void accept_baseline(const ResultSet& run, const std::filesystem::path& folder);

}  // namespace mosbench
