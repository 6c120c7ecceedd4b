#include "datasets/scan_file.hpp"

#include <system_error>

#include "datasets/bin_file.hpp"
#include "datasets/errors.hpp"
#include "datasets/pcd_file.hpp"

namespace mosbench {
namespace {

constexpr const char* kLayout =
    "a sequence folder: velodyne/ (or binFiles/) with one .bin per scan, beside it poses.txt and, "
    "where there is truth, labels/ or indices.csv";

bool is_pcd(const std::filesystem::path& file) { return file.extension() == ".pcd"; }

}  // namespace

std::optional<std::filesystem::path> scan_folder_of(const std::filesystem::path& sequence_folder) {
  for (const char* name : {"velodyne", "binFiles"}) {
    std::error_code ignored;
    const auto folder = sequence_folder / name;
    if (std::filesystem::is_directory(folder, ignored)) return folder;
  }
  return std::nullopt;
}

std::vector<StemFile> list_scans(const std::filesystem::path& sequence_folder) {
  const auto folder = scan_folder_of(sequence_folder);
  if (!folder) throw DataError(sequence_folder, "has no folder of scans", kLayout);
  auto scans = list_by_stem(*folder, {".bin", ".pcd"});
  if (scans.empty()) throw DataError(*folder, "holds no scan", kLayout);
  return scans;
}

std::vector<Point> read_scan(const std::filesystem::path& file) {
  return is_pcd(file) ? read_pcd(file) : read_bin(file);
}

std::size_t scan_point_count(const std::filesystem::path& file) {
  if (is_pcd(file)) return pcd_point_count(file);
  const std::uintmax_t size_bytes = size_of(file);
  check_bin_size(size_bytes, file);
  return static_cast<std::size_t>(size_bytes) / sizeof(Point);
}

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(file, error);
  if (error) throw DataError(file, "has no size (" + error.message() + ")", "a readable file");
  return size_bytes;
}

}  // namespace mosbench
