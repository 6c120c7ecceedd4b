#pragma once

#include <filesystem>
#include <string_view>

#include "datasets/formats/pcd_header.hpp"
#include "datasets/formats/pcl_module.hpp"

namespace mosbench {

/// Returns whether this build reads .pcd scans (MOSBENCH_WITH_PCL).
bool reads_pcd();

/// Unpacks the points of a PCD file through PCL; `bytes` is the whole file, checked. Throws
/// DataError when PCL is not there or refuses the file.
PclCloud unpack_pcd(std::string_view bytes, const PcdHeader& header,
                    const std::filesystem::path& file);

}  // namespace mosbench
