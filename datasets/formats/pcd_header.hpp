#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/formats/point_records.hpp"

namespace mosbench {

/// How the points behind the header of a PCD file are stored.
enum class PcdStorage : std::uint8_t { kAscii, kBinary, kCompressed };

/// What the header of a PCD file says of its points.
struct PcdHeader {
  std::size_t points = 0;
  std::vector<CloudField> fields;
  std::size_t point_bytes = 0;        ///< of one point, all fields
  std::size_t point_values = 0;       ///< numbers of one point, all fields
  std::size_t body_offset_bytes = 0;  ///< where the line after DATA starts
  PcdStorage storage = PcdStorage::kAscii;
  bool has_labels = false;        ///< there is a field "label"
  bool has_times = false;         ///< there is a field of `is_time_field`
  std::optional<Pose> viewpoint;  ///< map_from_sensor, when the header has one
};

/// Parses the header of a PCD file from `bytes`, which reach at least to the end of the line DATA.
/// Throws DataError for a missing or wrong line.
PcdHeader parse_pcd_header(std::string_view bytes, const std::filesystem::path& file);

/// Throws DataError when a file of this size is too short for the points of a binary body; the
/// other bodies' sizes are not known from the header.
void check_pcd_size(const PcdHeader& header, std::uintmax_t file_bytes,
                    const std::filesystem::path& file);

}  // namespace mosbench
