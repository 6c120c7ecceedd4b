#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Files with the labels of a scan: raw uint32, NumPy arrays, a table, or a labelled cloud.
inline const std::vector<std::string_view> kLabelExtensions = {".label", ".npy", ".npz",
                                                               ".csv",   ".ply", ".pcd"};

/// Reads the labels of a scan, one raw label id per point. A .npy array of booleans says what
/// moves. A .npz archive holds one array, or one that is named label or labels. A .csv file is read
/// by `parse_point_csv`, a cloud by its field `find_label_field`. Throws DataError.
std::vector<std::uint32_t> read_any_labels(const std::filesystem::path& file,
                                           std::size_t point_count);

/// Reads the labels of a .pcd or .ply cloud. Throws DataError, also when it has none.
std::vector<std::uint32_t> read_cloud_labels(const std::filesystem::path& file);

/// Returns whether a file of labels may say where its points are: a cloud, or a .csv file.
bool tells_points(const std::filesystem::path& file);

/// Throws DataError where a file of labels says, in the columns x, y and z, that its points are not
/// those of the scan of this name: in another order it would label the wrong ones.
void check_same_points(const std::filesystem::path& file, std::span<const Point> scan,
                       const std::string& scan_name);

/// Throws DataError where the size or the header of a file shows that it does not fit its scan.
void check_labels_fit(const std::filesystem::path& file, std::size_t point_count);

}  // namespace mosbench
