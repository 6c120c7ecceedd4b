#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/text/text.hpp"

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

/// Returns numbers of any type as raw label ids, one per point; 251.0 is 251. Throws DataError for
/// the first that is no whole number of 32 bits.
std::vector<std::uint32_t> label_ids(std::span<const double> numbers,
                                     const std::filesystem::path& file);

/// Throws DataError unless there is one label per point.
void check_label_count(std::size_t labels, std::size_t point_count,
                       const std::filesystem::path& file);

/// Returns the lines of a table, of one that Excel wrote without its mark of UTF-8.
std::vector<TextLine> table_lines(std::string_view text, const std::filesystem::path& file);

/// Parses labels from a CSV file with a row per point and a header with a column `label` (ids) or
/// `moving` (0 or 1); other columns are ignored. Throws DataError with the line.
std::vector<std::uint32_t> parse_point_csv(std::string_view text, std::size_t point_count,
                                           const std::filesystem::path& file);

void write_labels(const std::filesystem::path& file, std::span<const std::uint32_t> labels);

/// Parses labels of MOE: a row "Moveable_ID Moving_Status Class_ID" per point. The second number
/// decides: 1 is kMovingLabel, 0 kStaticLabel. Throws DataError with the line for other rows, and
/// for another number of rows than points.
std::vector<std::uint32_t> parse_moe_labels(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file);
std::vector<std::uint32_t> read_moe_labels(const std::filesystem::path& file,
                                           std::size_t point_count);

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

/// Parses the frame numbers of a HeLiMOS split (train.txt, val.txt, test.txt), one per line. Throws
/// DataError with the line for anything but a number, and for a file without numbers.
std::set<std::uint64_t> parse_split(std::string_view text, const std::filesystem::path& file);
std::string format_split(const std::set<std::uint64_t>& numbers);

}  // namespace mosbench
