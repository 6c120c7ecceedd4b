#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string_view>
#include <vector>

namespace mosbench {

/// Parses the points of a PLY file, ascii or binary of either byte order: properties x, y, z, and
/// intensity (0 when there is none) of its element "vertex", which has to come first; all others
/// are ignored. PCL's reader of PLY is not used: it accepts files that are cut off. Throws
/// DataError.
std::vector<Point> parse_ply(std::string_view bytes, const std::filesystem::path& file);

/// Returns one number per point as stored, of the property that `find_time_field` names. Throws as
/// `parse_ply`, and when there is none.
std::vector<double> parse_ply_times(std::string_view bytes, const std::filesystem::path& file);

/// Returns one raw label id per point, of the property that `find_label_field` names. Throws as
/// `parse_ply`, and when there is none.
std::vector<std::uint32_t> parse_ply_labels(std::string_view bytes,
                                            const std::filesystem::path& file);

/// What the header of a PLY file says of its points.
struct PlySummary {
  std::size_t points = 0;
  bool has_labels = false, has_times = false;
};

/// Reads the header in `head`, the start of a file of `file_bytes` bytes, and checks it against
/// that size; throws as `parse_ply`.
PlySummary parse_ply_summary(std::string_view head, std::uintmax_t file_bytes,
                             const std::filesystem::path& file);

}  // namespace mosbench
