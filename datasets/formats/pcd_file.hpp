#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
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
  bool has_labels = false;        ///< there is a field of `is_label_field`
  bool has_times = false;         ///< there is a field of `is_time_field`
  std::optional<Pose> viewpoint;  ///< map_from_sensor, when the header has one
};

/// Parses the header of a PCD file from `bytes`, which reach at least to the end of the line DATA.
/// Throws DataError for a missing or wrong line.
PcdHeader parse_pcd_header(std::string_view bytes, const std::filesystem::path& file);

/// What is read of a scan besides its points.
struct WantedParts {
  bool times = false, labels = false;
};

/// The points of a scan with what was wanted of each.
struct ScanParts {
  std::vector<Point> points;
  std::vector<double> times;          ///< as stored
  std::vector<std::uint32_t> labels;  ///< raw label ids
};

/// Parses a whole .pcd file, ascii, binary or binary_compressed: fields x, y, z, intensity (0 when
/// there is none), and as wanted those of `find_time_field` and `find_label_field`; all others are
/// ignored. Throws DataError for a body that is not the points of its header, where a wanted field
/// is not there, and for a label that is no whole number of 32 bits.
ScanParts parse_pcd(std::string_view bytes, const std::filesystem::path& file,
                    const WantedParts& wanted = {});

/// Unpacks LZF, in which .pcd files are compressed, to exactly `size_bytes`. Returns nothing for
/// bytes that do not unpack to that.
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size_bytes);

/// Reads the header alone, and checks it against the size of the file. Throws DataError.
PcdHeader read_pcd_header(const std::filesystem::path& file);

/// The points alone; throws as `parse_pcd`.
std::vector<Point> read_pcd(const std::filesystem::path& file);

/// Returns one raw label id per point, of the field `find_label_field`. Throws as `parse_pcd`, and
/// when there is none, or a label is no whole number of 32 bits.
std::vector<std::uint32_t> parse_pcd_labels(std::string_view bytes,
                                            const std::filesystem::path& file);

}  // namespace mosbench
