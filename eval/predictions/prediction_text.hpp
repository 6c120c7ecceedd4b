#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Which of Dynablox's three decisions per point counts; its paper reports objects.
enum class DynabloxLevel : std::uint8_t { kPoint, kCluster, kObject };

/// Throws UsageError for a name that is not point, cluster or object.
DynabloxLevel dynablox_level_named(std::string_view name);
/// Returns the name that `dynablox_level_named` takes.
std::string_view to_string(DynabloxLevel level);

/// Parses labels (9 or 251) from a text file with a row per point: "0" or "1", or "moveable moving
/// class". Throws DataError with the line.
std::vector<std::uint32_t> parse_point_text(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file);

/// Parses labels from a CSV file with a row per point and a header with a column `label` (ids) or
/// `moving` (0 or 1); other columns are ignored. Throws DataError with the line.
std::vector<std::uint32_t> parse_point_csv(std::string_view text, std::size_t point_count,
                                           const std::filesystem::path& file);

/// Parses the labels of each cloud of Dynablox's clouds.csv, by CloudNo from 0. Throws DataError.
std::vector<std::vector<std::uint32_t>> parse_dynablox_clouds(std::string_view text,
                                                              DynabloxLevel level,
                                                              const std::filesystem::path& file);

/// Counts in a row of Dynablox's scores.csv.
struct DynabloxCounts {
  Confusion counts;
  std::uint64_t total_points = 0;
};

/// Throws DataError with the line, also when the counts do not add up to EvaluatedPoints.
std::vector<DynabloxCounts> parse_dynablox_counts(std::string_view text, DynabloxLevel level,
                                                  const std::filesystem::path& file);

/// Parses the first column of Dynablox's scores.csv, whatever levels it evaluated. Throws DataError
/// with the line.
std::vector<std::uint64_t> parse_dynablox_stamps_ns(std::string_view text,
                                                    const std::filesystem::path& file);

}  // namespace mosbench
