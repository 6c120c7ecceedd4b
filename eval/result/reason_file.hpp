#pragma once

#include <cstddef>
#include <filesystem>
#include <mosbench/method.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace mosbench {

/// Reads LabelledScan::reasons, a byte per point. Throws DataError unless there are exactly
/// `point_count`, all of them values of Reason.
std::vector<Reason> parse_reasons(std::string_view bytes, std::size_t point_count,
                                  const std::filesystem::path& file);
/// Returns the bytes of a file without copying the reasons.
std::string_view format_reasons(std::span<const Reason> reasons);

/// reasons/<stem>.reason of a run's folder.
std::filesystem::path reason_file(const std::filesystem::path& folder, std::string_view stem);

}  // namespace mosbench
