#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/results/result_set.hpp"

namespace mosbench {

/// Text of an accepted result.json: what `read_sequence_result` reads, without what depends on the
/// clock or the machine, so that accepting the same results again changes nothing.
std::string format_accepted(const SequenceResult& result);

/// The runs whose results lie in a folder; none where it is not there or holds no result.
std::vector<ResultSet> accepted_runs(const std::filesystem::path& folder);

/// Writes <folder>/<sequence>/result.json for every sequence of the run; sequences that the folder
/// holds already and the run has not are removed. Throws DataError.
void accept_baseline(const ResultSet& run, const std::filesystem::path& folder);

}  // namespace mosbench
