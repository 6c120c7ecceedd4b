#pragma once

#include <cstddef>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string_view>

namespace mosbench {

/// What the header of a PCD file says of its points.
struct PcdHeader {
  std::size_t points = 0;
  std::size_t body_offset_bytes = 0;  ///< where the line after DATA starts
  bool has_labels = false;            ///< there is a field "label"
  std::optional<Pose> viewpoint;      ///< of the sensor, when the header tells
};

/// Checks a whole PCD file: every line of the header that is needed, and that the data behind it
/// are all there. PCL's own reader crashes on files without a header and takes text for zeros, so
/// no file goes to it unchecked. Throws DataError.
PcdHeader check_pcd(std::string_view bytes, const std::filesystem::path& file);

}  // namespace mosbench
