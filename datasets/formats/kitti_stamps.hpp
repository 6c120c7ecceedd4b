#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Parses timestamps.txt of KITTI's raw data: "2011-09-26 13:02:25.594360375" per frame, as
/// nanoseconds since 1970; an empty line is a frame that was not recorded. Throws DataError with
/// the line.
std::vector<std::optional<std::int64_t>> parse_kitti_stamps(std::string_view text,
                                                            const std::filesystem::path& file);
std::string format_kitti_stamps(std::span<const std::optional<std::int64_t>> stamps_ns);

}  // namespace mosbench
