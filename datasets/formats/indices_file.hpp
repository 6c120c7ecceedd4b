#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// The truth of one scan in a DOALS indices.csv.
struct IndicesRow {
  std::int64_t stamp_ns = 0;
  std::vector<std::uint32_t> moving;  ///< 0-based, raw firing order; sorted, each once
  std::size_t line = 0;               ///< in its file, from 1; not needed for writing
};

/// Parses rows "stamp_ns,index,index,...". A row without index is a scan in which nothing moves.
/// Throws DataError with the line for text, a negative number or a repeated stamp.
std::vector<IndicesRow> parse_indices(std::string_view text, const std::filesystem::path& file);
std::string format_indices(std::span<const IndicesRow> rows);

/// Throws DataError with the row's line when an index lies beyond its scan's `point_count`.
void check_indices(const IndicesRow& row, std::size_t point_count,
                   const std::filesystem::path& file);

std::vector<IndicesRow> read_indices(const std::filesystem::path& file);
void write_indices(const std::filesystem::path& file, std::span<const IndicesRow> rows);

}  // namespace mosbench
