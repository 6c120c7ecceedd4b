#include "datasets/formats/pcd_file.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include "datasets/disk/files.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/point_times.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

void require_pcl(const std::filesystem::path& file) {
  if (reads_pcd()) return;
  throw DataError(file, "this build reads no .pcd files",
                  ".bin scans, or a build with PCL (install libpcl-dev, configure with "
                  "-DMOSBENCH_WITH_PCL=ON)");
}

/// The points of a .pcd file as records of fields.
struct PcdRecords {
  PclCloud cloud;
  std::string_view bytes() const {
    return {reinterpret_cast<const char*>(cloud.records.data()), cloud.records.size()};
  }
};

/// Reads and checks the whole file; the records of a file without points are empty.
PcdRecords read_records(const std::filesystem::path& file) {
  require_pcl(file);
  const std::string bytes = read_file(file);
  const PcdHeader header = parse_pcd_header(bytes, file);
  check_pcd_body(header, bytes, file);
  PcdRecords records;
  if (header.points == 0) return records;
  records.cloud = unpack_pcd(bytes, header, file);
  records.cloud.head.height = 1;
  records.cloud.head.width = static_cast<std::uint32_t>(header.points);
  return records;
}

std::vector<Point> points_of(const PcdRecords& records, const std::filesystem::path& file) {
  if (records.cloud.head.points() == 0) return {};
  return points_of(records.cloud.head, records.bytes(), file);
}

std::optional<std::vector<std::uint32_t>> labels_of(const PcdRecords& records,
                                                    const std::filesystem::path& file) {
  const CloudField* field = find_field(records.cloud.head, "label");
  if (field == nullptr) return std::nullopt;
  std::vector<std::uint32_t> labels;
  labels.reserve(records.cloud.head.points());
  for (const double value : numbers_of(records.cloud.head, *field, records.bytes(), file)) {
    if (!(value >= 0.0 && value <= 4294967295.0 && value == std::floor(value))) {
      throw DataError(file, "point " + std::to_string(labels.size()) + " has a label that is no id",
                      "whole numbers");
    }
    labels.push_back(static_cast<std::uint32_t>(value));
  }
  return labels;
}

std::vector<double> times_of(const PcdRecords& records, const std::filesystem::path& file) {
  const CloudHead& head = records.cloud.head;
  if (head.points() == 0) return {};
  const CloudField* field = find_time_field(head);
  if (field == nullptr) throw DataError(file, "the points have no times", kTimeFields);
  return numbers_of(head, *field, records.bytes(), file);
}

}  // namespace

PcdHeader read_pcd_header(const std::filesystem::path& file) {
  require_pcl(file);
  const PcdHeader header = parse_pcd_header(read_head(file, "DATA"), file);
  check_pcd_size(header, size_of(file), file);
  return header;
}

PcdScan read_pcd_scan(const std::filesystem::path& file, bool timed) {
  const PcdRecords records = read_records(file);
  return {points_of(records, file), labels_of(records, file),
          timed ? times_of(records, file) : std::vector<double>()};
}

std::vector<Point> read_pcd(const std::filesystem::path& file) {
  return points_of(read_records(file), file);
}

std::vector<std::uint32_t> read_pcd_labels(const std::filesystem::path& file) {
  const PcdRecords records = read_records(file);
  if (records.cloud.head.points() == 0) return {};
  auto labels = labels_of(records, file);
  if (!labels) throw DataError(file, "the points have no field label", "a number of that name");
  return *labels;
}

}  // namespace mosbench
