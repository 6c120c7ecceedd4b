#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Returns the points of a scan stored as little-endian float32 x y z intensity, metres. No bytes
/// are an empty scan; NaN and infinite values are kept. Throws DataError when the size is no
/// multiple of 16 bytes.
std::vector<Point> parse_bin(std::string_view bytes, const std::filesystem::path& file);
/// Parses `columns` float32 per point, at least three, and keeps the first four: nuScenes adds the
/// ring. The intensity of three is 0.
std::vector<Point> parse_bin(std::string_view bytes, std::size_t columns,
                             const std::filesystem::path& file);
/// Returns the number after x y z intensity of every point: seconds after the stamp of its scan, in
/// nanoseconds. Throws DataError also for times that are not within a second.
std::vector<std::int64_t> parse_bin_times(std::string_view bytes, std::size_t columns,
                                          const std::filesystem::path& file);
/// Returns the points' own memory as the bytes of a file.
std::string_view format_bin(std::span<const Point> points);

/// Throws the DataError of `parse_bin` when no scan has this size.
void check_bin_size(std::uintmax_t size_bytes, std::size_t columns,
                    const std::filesystem::path& file);

/// Reads a file as `parse_bin` does, into the memory of `reused` where it can.
std::vector<Point> read_bin(const std::filesystem::path& file, std::size_t columns = 4,
                            std::vector<Point> reused = {});
void write_bin(const std::filesystem::path& file, std::span<const Point> points);

}  // namespace mosbench
