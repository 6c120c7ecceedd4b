#include "datasets/formats/scan_file.hpp"

#include <fmt/format.h>

#include <set>
#include <system_error>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr const char* kLayout =
    "a sequence folder: velodyne/ (or binFiles/) with one .bin per scan, next to it poses.txt "
    "and, where there is truth, labels/ or indices.csv";

constexpr std::string_view kNuscenesEnd = ".pcd.bin";
constexpr std::size_t kNuscenesColumns = 5;

bool has_extension(const std::filesystem::path& file, const char* extension) {
  return file.extension() == extension;
}

std::size_t columns_of(const std::filesystem::path& file, std::size_t asked) {
  return file.string().ends_with(kNuscenesEnd) ? kNuscenesColumns : asked;
}

}  // namespace

std::optional<std::filesystem::path> scan_folder_of(const std::filesystem::path& sequence_folder) {
  for (const char* name : {"velodyne", "binFiles", "LIDAR_TOP"}) {
    std::error_code ignored;
    const auto folder = sequence_folder / name;
    if (std::filesystem::is_directory(folder, ignored)) return folder;
  }
  return std::nullopt;
}

bool is_named_as_scan(const std::filesystem::path& file) {
  return has_extension(file, ".bin") || has_extension(file, ".pcd") || has_extension(file, ".ply");
}

std::vector<StemFile> scans_in(const std::filesystem::path& folder) {
  auto scans = list_by_stem(folder, {".bin", ".pcd", ".ply"});
  for (StemFile& scan : scans) {
    if (scan.file.string().ends_with(kNuscenesEnd)) scan.stem.resize(scan.stem.size() - 4);
  }
  return scans;
}

std::vector<StemFile> list_scan_folder(const std::filesystem::path& scan_folder) {
  auto scans = scans_in(scan_folder);
  if (scans.empty()) throw DataError(scan_folder, "holds no scan", kLayout);
  return scans;
}

std::vector<StemFile> list_scans(const std::filesystem::path& sequence_folder) {
  const auto folder = scan_folder_of(sequence_folder);
  if (!folder) throw DataError(sequence_folder, "has no folder of scans", kLayout);
  return list_scan_folder(*folder);
}

std::vector<Point> read_scan(const std::filesystem::path& file, std::size_t bin_columns,
                             std::vector<Point> reused) {
  if (has_extension(file, ".pcd")) return read_pcd(file);
  if (has_extension(file, ".ply")) return parse_ply(read_file(file), file);
  return read_bin(file, columns_of(file, bin_columns), std::move(reused));
}

ScanParts read_scan_parts(const std::filesystem::path& file, std::size_t bin_columns,
                          const WantedParts& wanted) {
  const std::string bytes = read_file(file);
  if (has_extension(file, ".pcd")) return parse_pcd(bytes, file, wanted);
  ScanParts parts;
  if (has_extension(file, ".ply")) {
    parts.points = parse_ply(bytes, file);
    if (wanted.times) parts.times = parse_ply_times(bytes, file);
    if (wanted.labels) parts.labels = parse_ply_labels(bytes, file);
    return parts;
  }
  const std::size_t columns = columns_of(file, bin_columns);
  parts.points = parse_bin(bytes, columns, file);
  if (wanted.times) parts.times = parse_bin_times(bytes, columns, file);
  return parts;
}

void check_usual_bin_columns(std::span<const StemFile> scans) {
  if (scans.empty()) return;
  for (const std::size_t i : std::set{std::size_t{0}, scans.size() / 2, scans.size() - 1}) {
    const std::filesystem::path& file = scans[i].file;
    if (!has_extension(file, ".bin") || file.string().ends_with(kNuscenesEnd)) continue;
    const std::string bytes = read_file(file);
    if (const std::string_view numbers = other_bin_numbers(bytes); !numbers.empty()) {
      throw DataError(file, fmt::format("holds {}", numbers), "little-endian float32");
    }
    const auto columns = other_bin_columns(bytes, kUsualBinColumns);
    if (!columns) continue;
    throw DataError(file,
                    fmt::format("seems to hold {} float32 per point rather than {} (x y z "
                                "intensity)",
                                *columns, kUsualBinColumns),
                    fmt::format("{}, or {} if it is as it should be",
                                option("bin_columns", std::to_string(*columns)), kUsualBinColumns));
  }
}

ScanHead read_scan_head(const std::filesystem::path& file, std::size_t bin_columns) {
  if (has_extension(file, ".pcd")) {
    const PcdHeader header = read_pcd_header(file);
    return {header.points, header.has_labels, header.has_times};
  }
  if (has_extension(file, ".ply")) {
    const PlySummary summary =
        parse_ply_summary(read_head(file, "end_header"), size_of(file), file);
    return {summary.points, summary.has_labels, summary.has_times};
  }
  const std::uintmax_t size_bytes = size_of(file);
  const std::size_t columns = columns_of(file, bin_columns);
  check_bin_size(size_bytes, columns, file);
  return {.points = static_cast<std::size_t>(size_bytes) / (columns * sizeof(float)),
          .has_times = columns > 4};
}

}  // namespace mosbench
