#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/point_times.hpp"

namespace mosbench {

/// Returns a decimal number of seconds (with or without exponent) as nanoseconds, exact because it
/// works on the digits; those after the ninth decimal round half away from zero. Returns nothing
/// for text or beyond 64 bits.
/// The text is in a unit of 10^-decimals_of_unit seconds.
std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text, int decimals_of_unit = 0);

/// Parses times.txt: one time per scan, in seconds or another unit up to ns. Throws DataError with
/// the line.
std::vector<std::int64_t> parse_times(std::string_view text, const std::filesystem::path& file,
                                      TimeUnit unit = TimeUnit::kSeconds);
/// Returns the numbers as they stand, 0 for text.
std::vector<double> parse_time_numbers(std::string_view text, const std::filesystem::path& file);
/// Returns the unit of the numbers that rows begin with, which should be seconds; lines with # are
/// comments.
TimeUnit unit_of_rows(std::string_view text, const std::filesystem::path& file);
/// Formats nanoseconds as seconds with nine decimals.
std::string seconds_text(std::int64_t stamp_ns);
/// Formats times.txt: seconds with nine decimals, one per line.
std::string format_times(std::span<const std::int64_t> stamps_ns);

std::vector<std::int64_t> read_times(const std::filesystem::path& file);
void write_times(const std::filesystem::path& file, std::span<const std::int64_t> stamps_ns);

/// Parses timestamps.txt of KITTI's raw data: "2011-09-26 13:02:25.594360375" per frame, as
/// nanoseconds since 1970; an empty line is a frame that was not recorded. Throws DataError with
/// the line.
std::vector<std::optional<std::int64_t>> parse_kitti_stamps(std::string_view text,
                                                            const std::filesystem::path& file);
std::string format_kitti_stamps(std::span<const std::optional<std::int64_t>> stamps_ns);

}  // namespace mosbench
