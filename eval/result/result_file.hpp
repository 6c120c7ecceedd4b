#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "eval/result/result.hpp"

namespace mosbench {

/// Text of a result.json, with one line per scan.
std::string format_result(const Result& result);

/// Every result.json below a folder (or the file itself), `deepest` levels of folders at most,
/// ordered by path, but not those that killed runs left; empty when there is none. Throws
/// DataError for a path that cannot be read, unless `how` passes over it.
std::vector<std::filesystem::path> find_result_files(
    const std::filesystem::path& path,
    std::filesystem::directory_options how = std::filesystem::directory_options::none,
    int deepest = std::numeric_limits<int>::max());

/// Reads what `format_result` wrote, or an earlier version; throws DataError naming the file for
/// anything else.
Result read_result(const std::filesystem::path& file);
/// Reads all of `find_result_files`. Throws DataError when there is none.
std::vector<Result> read_results(const std::filesystem::path& path);

}  // namespace mosbench
