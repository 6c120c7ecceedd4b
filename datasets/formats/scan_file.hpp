#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/pcd_file.hpp"

namespace mosbench {

/// Whether a file is named as a scan: .bin, .pcd or .ply.
bool is_named_as_scan(const std::filesystem::path& file);

/// Returns the folder of scans in a sequence folder: velodyne/, else binFiles/, else LIDAR_TOP/
/// (nuScenes), else nothing.
std::optional<std::filesystem::path> scan_folder_of(const std::filesystem::path& sequence_folder);

/// Lists the scans (.bin, .pcd, .ply) of a folder in order; none where it holds none.
std::vector<StemFile> scans_in(const std::filesystem::path& folder);
/// The same, but throws DataError when there are none.
std::vector<StemFile> list_scan_folder(const std::filesystem::path& scan_folder);
/// Lists those of `scan_folder_of`. Throws DataError also when there is no such folder.
std::vector<StemFile> list_scans(const std::filesystem::path& sequence_folder);

/// Reads the points of a scan into the memory of `reused` where it can. A .bin file has
/// `bin_columns` float32 per point, one that ends in .pcd.bin five as in nuScenes. Throws
/// DataError.
std::vector<Point> read_scan(const std::filesystem::path& file, std::size_t bin_columns = 4,
                             std::vector<Point> reused = {});

/// Reads a scan with what is wanted of its points: of a .bin file times after x y z intensity, of a
/// .pcd or .ply file the fields `find_time_field` and `find_label_field`. Throws DataError.
ScanParts read_scan_parts(const std::filesystem::path& file, std::size_t bin_columns,
                          const WantedParts& wanted);

/// Looks into some of the scans, if they are .bin files, whether they have four little-endian
/// float32 per point, which nothing in them says. Throws DataError where they clearly have others.
void check_usual_bin_columns(std::span<const StemFile> scans);

/// What the size or the header of a scan file says.
struct ScanHead {
  std::size_t points = 0;
  bool has_labels = false;  ///< the points have a field of `is_label_field`
  bool has_times = false;   ///< the points have times, or a fifth column that may be
};

/// Reads no more than the header of a scan. Throws DataError.
ScanHead read_scan_head(const std::filesystem::path& file, std::size_t bin_columns = 4);

}  // namespace mosbench
