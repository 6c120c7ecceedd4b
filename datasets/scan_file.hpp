#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/scan.hpp"
#include "datasets/folder_listing.hpp"

namespace mosbench {

/// The folder of scans in a sequence folder: velodyne/, else binFiles/, else nothing.
std::optional<std::filesystem::path> scan_folder_of(const std::filesystem::path& sequence_folder);

/// The scans (.bin and .pcd) in order. Throws DataError when the sequence folder has no scan folder
/// or that one no scan.
std::vector<StemFile> list_scans(const std::filesystem::path& sequence_folder);

/// Points of a .bin or .pcd scan; throws DataError.
std::vector<Point> read_scan(const std::filesystem::path& file);

/// Points of a scan by its size or header; throws DataError.
std::size_t scan_point_count(const std::filesystem::path& file);

/// Size of a file in bytes; throws DataError.
std::uintmax_t size_of(const std::filesystem::path& file);

}  // namespace mosbench
