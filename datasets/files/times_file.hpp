#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A decimal number of seconds (with or without exponent) as nanoseconds, by digits and so exact;
/// digits behind the ninth decimal round half away from zero. Nothing for text or beyond 64 bits.
std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text);

/// times.txt: one time in seconds per scan. Throws DataError with the line.
std::vector<std::int64_t> parse_times(std::string_view text, const std::filesystem::path& file);
/// Seconds with nine decimals.
std::string format_times(std::span<const std::int64_t> stamps_ns);

std::vector<std::int64_t> read_times(const std::filesystem::path& file);
void write_times(const std::filesystem::path& file, std::span<const std::int64_t> stamps_ns);

}  // namespace mosbench
