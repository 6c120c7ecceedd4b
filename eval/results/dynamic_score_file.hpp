#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Dynamic scores (ScanResult::scores) stored as little-endian int32, one per point, none negative.
/// Throws DataError unless there are exactly `point_count`.
std::vector<std::int32_t> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                               const std::filesystem::path& file);
/// The bytes of a file, where the scores lie.
std::string_view format_dynamic_scores(std::span<const std::int32_t> scores);

/// scores/<stem>.score of a run's folder.
std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem);

}  // namespace mosbench
