#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace mosbench {

/// Parses labels of MOE: a row "Moveable_ID Moving_Status Class_ID" per point. The second number
/// decides: 1 is kMovingLabel, 0 kStaticLabel. Throws DataError with the line for other rows, and
/// for another number of rows than points.
std::vector<std::uint32_t> parse_moe_labels(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file);
std::vector<std::uint32_t> read_moe_labels(const std::filesystem::path& file,
                                           std::size_t point_count);

}  // namespace mosbench
