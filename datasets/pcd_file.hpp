#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/scan.hpp"

namespace mosbench {

/// Whether this build reads .pcd scans (MOSBENCH_WITH_PCL).
bool reads_pcd();

/// A .pcd scan read through PCL: fields x, y, z, and intensity (0 when there is none); all other
/// fields are left aside. Throws DataError for what PCL cannot read, and always in a build without
/// PCL (MOSBENCH_WITH_PCL=OFF).
std::vector<Point> read_pcd(const std::filesystem::path& file);

/// Points of a .pcd scan by its header, the file checked; throws as `read_pcd`.
std::size_t pcd_point_count(const std::filesystem::path& file);

}  // namespace mosbench
