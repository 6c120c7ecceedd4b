#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Returns raw label ids stored as little-endian uint32, one per point: the class in the lower 16
/// bits, an instance in the upper ones. Throws DataError unless there are exactly `point_count`.
std::vector<std::uint32_t> parse_labels(std::string_view bytes, std::size_t point_count,
                                        const std::filesystem::path& file);
/// Returns the labels' own memory as the bytes of a file.
std::string_view format_labels(std::span<const std::uint32_t> labels);

/// Throws the DataError of `parse_labels` for a size in bytes that does not fit the scan.
void check_label_size(std::uintmax_t size_bytes, std::size_t point_count,
                      const std::filesystem::path& file);

std::vector<std::uint32_t> read_labels(const std::filesystem::path& file, std::size_t point_count);
void write_labels(const std::filesystem::path& file, std::span<const std::uint32_t> labels);

}  // namespace mosbench
