#include "datasets/formats/label_formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <mosbench/scan.hpp>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/npy_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// Returns the array that holds the labels.
std::string labels_in_npz(std::string_view bytes, const fs::path& file) {
  std::vector<ArchiveMember> members = unpack_npz(bytes, file);
  if (members.size() == 1) return std::move(members.front().bytes);
  std::vector<std::string> names;
  for (ArchiveMember& member : members) {
    if (member.name == "label.npy" || member.name == "labels.npy") return std::move(member.bytes);
    names.push_back(std::move(member.name));
  }
  throw DataError(file, fmt::format("holds the arrays {}", fmt::join(names, ", ")),
                  "one array, or one of the name labels");
}

std::vector<std::uint32_t> labels_of(const NumpyArray& array, const fs::path& file) {
  if (!array.is_boolean) return label_ids(array.numbers, file);
  std::vector<std::uint32_t> labels;
  for (const double moves : array.numbers) {
    labels.push_back(moves != 0.0 ? kMovingLabel : kStaticLabel);
  }
  return labels;
}

}  // namespace

std::vector<std::uint32_t> read_cloud_labels(const fs::path& file) {
  const auto parse = file.extension() == ".ply" ? parse_ply_labels : parse_pcd_labels;
  return parse(read_file(file), file);
}

std::vector<std::uint32_t> read_any_labels(const fs::path& file, std::size_t point_count) {
  const fs::path extension = file.extension();
  if (extension == ".label") return read_labels(file, point_count);
  if (extension == ".csv") return parse_point_csv(read_file(file), point_count, file);
  std::vector<std::uint32_t> labels;
  if (is_named_as_scan(file)) {
    labels = read_cloud_labels(file);
  } else {
    std::string bytes = read_file(file);
    if (extension == ".npz") bytes = labels_in_npz(bytes, file);
    labels = labels_of(parse_npy(bytes, file), file);
  }
  check_label_count(labels.size(), point_count, file);
  return labels;
}

void check_labels_fit(const fs::path& file, std::size_t point_count) {
  if (file.extension() == ".label") check_label_size(size_of(file), point_count, file);
  if (is_named_as_scan(file)) check_label_count(read_scan_head(file).points, point_count, file);
}

}  // namespace mosbench
