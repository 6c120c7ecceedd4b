#pragma once

#include <optional>
#include <string>

#include "datasets/sequence/sequence.hpp"
#include "eval/results/result_file.hpp"

namespace mosbench {

/// Whether a result was made from the frames that `sequence` has now; `stamp` is its `file_stamp`.
/// Files that were merely copied or touched hold the same frames: only then, and without a stamp,
/// are those read. Throws DataError.
bool same_input(const Sequence& sequence, const std::optional<std::string>& stamp,
                const ResultFile& result);

}  // namespace mosbench
