#include "datasets/formats/label_formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/npy_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

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
  if (array.kind != NumpyKind::kBooleans) return label_ids(array.numbers, file);
  std::vector<std::uint32_t> labels;
  for (const double moves : array.numbers) {
    labels.push_back(moves != 0.0 ? kMovingLabel : kStaticLabel);
  }
  return labels;
}

/// By the ids, 0 and 1 are no truth: no point with them counts.
void refuse_classes(const std::vector<std::uint32_t>& labels, const fs::path& file) {
  if (labels.empty() || std::ranges::max(labels) != 1) return;
  throw DataError(file, "holds the labels 0 and 1 alone",
                  "label ids (9 static, 251 moving), a .npy array of booleans, or a column moving "
                  "in a .csv file");
}

/// Nothing where it does not say it.
std::vector<Point> points_of_labels(const fs::path& file) {
  if (is_named_as_scan(file)) return read_scan(file);
  if (file.extension() != ".csv") return {};
  const std::string text = read_file(file);
  const std::vector<TextLine> lines = table_lines(text, file);
  std::vector<std::size_t> columns;
  if (!lines.empty()) {
    const std::vector<std::string_view> header = split_at_commas(lines.front().text);
    for (const std::string_view name : {"x", "y", "z"}) {
      const auto column = std::ranges::find(header, name);
      if (column == header.end()) return {};
      columns.push_back(static_cast<std::size_t>(column - header.begin()));
    }
  }
  std::vector<Point> points;
  for (const TextLine& line : std::span(lines).subspan(lines.empty() ? 0 : 1)) {
    const std::vector<std::string_view> fields = split_at_commas(line.text);
    std::array<float, 3> at{};
    for (std::size_t axis = 0; axis < at.size(); ++axis) {
      const auto number =
          columns[axis] < fields.size() ? parse_double(fields[columns[axis]]) : std::nullopt;
      if (!number)
        throw DataError(file, line.number, "has no number in x, y or z", "three numbers");
      at[axis] = static_cast<float>(*number);
    }
    points.push_back({at[0], at[1], at[2], 0.0F});
  }
  return points;
}

}  // namespace

std::vector<std::uint32_t> read_cloud_labels(const fs::path& file) {
  const auto parse = file.extension() == ".ply" ? parse_ply_labels : parse_pcd_labels;
  return parse(read_file(file), file);
}

std::vector<std::uint32_t> read_any_labels(const fs::path& file, std::size_t point_count) {
  const fs::path extension = file.extension();
  if (extension == ".label") return read_labels(file, point_count);
  std::vector<std::uint32_t> labels;
  if (extension == ".csv") {
    labels = parse_point_csv(read_file(file), point_count, file);
  } else if (is_named_as_scan(file)) {
    labels = read_cloud_labels(file);
  } else {
    std::string bytes = read_file(file);
    if (extension == ".npz") bytes = labels_in_npz(bytes, file);
    labels = labels_of(parse_npy(bytes, file), file);
  }
  check_label_count(labels.size(), point_count, file);
  refuse_classes(labels, file);
  return labels;
}

bool tells_points(const fs::path& file) {
  return file.extension() == ".csv" || is_named_as_scan(file);
}

void check_same_points(const fs::path& file, std::span<const Point> scan,
                       const std::string& scan_name) {
  constexpr float kSame_m = 0.01F;  // clouds are written with a few digits
  const std::vector<Point> labelled = points_of_labels(file);
  for (std::size_t i = 0; i < std::min(scan.size(), labelled.size()); ++i) {
    const Eigen::Vector3f at(scan[i].x, scan[i].y, scan[i].z);
    const Eigen::Vector3f other(labelled[i].x, labelled[i].y, labelled[i].z);
    if (!at.allFinite() || !((at - other).cwiseAbs().maxCoeff() > kSame_m)) continue;
    throw DataError(file, fmt::format("point {} is not where it is in the scan", i),
                    "the points of " + scan_name + ", in their order and frame");
  }
}

void check_labels_fit(const fs::path& file, std::size_t point_count) {
  if (file.extension() == ".label") check_label_size(size_of(file), point_count, file);
  if (is_named_as_scan(file)) check_label_count(read_scan_head(file).points, point_count, file);
}

}  // namespace mosbench
