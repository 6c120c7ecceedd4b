#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <vector>

#include "datasets/formats/pcd_header.hpp"
#include "datasets/formats/pcl_reader.hpp"

namespace mosbench {

/// A .pcd scan whose points may have labels and times.
struct PcdScan {
  std::vector<Point> points;
  std::optional<std::vector<std::uint32_t>> labels;  ///< one per point, of the field "label"
  std::vector<double> times;  ///< as stored, of the field `find_time_field`, if asked for
};

/// Reads the header alone, and checks it against the size of the file. Throws DataError, in a build
/// without PCL (MOSBENCH_WITH_PCL=OFF) always.
PcdHeader read_pcd_header(const std::filesystem::path& file);

/// Reads a .pcd scan once, unpacked by PCL: fields x, y, z, intensity (0 when there is none),
/// label, and with `timed` the times; all other fields are ignored. Throws DataError for what PCL
/// cannot read and for labels that are no whole numbers of 32 bits, and as `read_pcd_header`.
PcdScan read_pcd_scan(const std::filesystem::path& file, bool timed = false);

/// The points alone; throws as `read_pcd_scan`.
std::vector<Point> read_pcd(const std::filesystem::path& file);

/// The labels alone; throws as `read_pcd_scan`, and when the points have no field "label".
std::vector<std::uint32_t> read_pcd_labels(const std::filesystem::path& file);

}  // namespace mosbench
