#pragma once

#include <filesystem>
#include <string>

#include "eval/result_set.hpp"

namespace mosbench {

/// Text of an accepted result.json: what `read_sequence_result` reads, without what depends on the
/// clock or the machine, so that accepting the same results again changes nothing.
std::string format_accepted(const SequenceResult& result);

/// Writes <folder>/<sequence>/result.json for every sequence of the run; sequences that the folder
/// holds already and the run has not are removed. Throws DataError.
void accept_baseline(const ResultSet& run, const std::filesystem::path& folder);

}  // namespace mosbench
