#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <vector>

#include "datasets/files/pcd_header.hpp"

namespace mosbench {

/// Whether this build reads .pcd scans (MOSBENCH_WITH_PCL).
bool reads_pcd();

/// A .pcd scan read through PCL: fields x, y, z, and intensity (0 when there is none); all other
/// fields are left aside. Throws DataError for what PCL cannot read, and always in a build without
/// PCL (MOSBENCH_WITH_PCL=OFF).
std::vector<Point> read_pcd(const std::filesystem::path& file);

/// What the header of a .pcd scan tells, the file checked; throws as `read_pcd`.
PcdHeader read_pcd_header(const std::filesystem::path& file);

/// Whether each point has a field "label", and its values; throw as `read_pcd`.
bool pcd_has_labels(const std::filesystem::path& file);
std::vector<std::uint32_t> read_pcd_labels(const std::filesystem::path& file);

/// Points of a .pcd scan by its header, the file checked; throws as `read_pcd`.
std::size_t pcd_point_count(const std::filesystem::path& file);

}  // namespace mosbench
