#include "datasets/pcd_file.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include "datasets/errors.hpp"
#include "datasets/files.hpp"
#include "datasets/pcd_header.hpp"

namespace mosbench {
namespace {

template <typename Stored>
double load(const std::uint8_t* bytes) {
  Stored value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

using LoadField = double (*)(const std::uint8_t*);

/// Nothing for a type that PCL does not define.
LoadField loader_of(std::uint8_t datatype) {
  switch (datatype) {
    case pcl::PCLPointField::FLOAT32:
      return load<float>;
    case pcl::PCLPointField::FLOAT64:
      return load<double>;
    case pcl::PCLPointField::INT8:
      return load<std::int8_t>;
    case pcl::PCLPointField::UINT8:
      return load<std::uint8_t>;
    case pcl::PCLPointField::INT16:
      return load<std::int16_t>;
    case pcl::PCLPointField::UINT16:
      return load<std::uint16_t>;
    case pcl::PCLPointField::INT32:
      return load<std::int32_t>;
    case pcl::PCLPointField::UINT32:
      return load<std::uint32_t>;
    default:
      return nullptr;
  }
}

double zero(const std::uint8_t*) { return 0.0; }

struct FieldReader {
  LoadField load = zero;
  std::size_t offset_bytes = 0;
  double value(const std::uint8_t* point) const { return load(point + offset_bytes); }
  float operator()(const std::uint8_t* point) const { return static_cast<float>(value(point)); }
};

FieldReader field_reader(const pcl::PCLPointCloud2& cloud, std::string_view name, bool required,
                         const std::filesystem::path& file) {
  for (const pcl::PCLPointField& field : cloud.fields) {
    if (field.name != name) continue;
    const LoadField load_field = loader_of(field.datatype);
    if (load_field == nullptr || field.count != 1) break;
    return {load_field, field.offset};
  }
  if (!required) return {};
  throw DataError(file, "has no numeric field " + std::string(name), "fields x y z [intensity]");
}

/// The checked file as PCL reads it, with `count` points.
void read_cloud(const std::filesystem::path& file, std::size_t count, pcl::PCLPointCloud2& cloud) {
  // PCL would report every bad file on the console as well.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  std::string why;
  try {
    if (pcl::PCDReader().read(file.string(), cloud) >= 0) {
      if (cloud.point_step > 0 && cloud.data.size() / cloud.point_step >= count) return;
      why = " (less than the points of its header)";
    }
  } catch (const std::exception& error) {
    why = std::string(" (") + error.what() + ")";
  }
  throw DataError(file, "cannot be read as a point cloud" + why,
                  "a PCD file, version 0.7, with fields x y z [intensity]");
}

}  // namespace

bool reads_pcd() { return true; }

std::vector<Point> read_pcd(const std::filesystem::path& file) {
  const std::size_t count = pcd_point_count(file);
  if (count == 0) return {};
  pcl::PCLPointCloud2 cloud;
  read_cloud(file, count, cloud);
  const FieldReader x = field_reader(cloud, "x", true, file);
  const FieldReader y = field_reader(cloud, "y", true, file);
  const FieldReader z = field_reader(cloud, "z", true, file);
  const FieldReader intensity = field_reader(cloud, "intensity", false, file);

  std::vector<Point> points(count);
  const std::uint8_t* record = cloud.data.data();
  for (Point& point : points) {
    point = {x(record), y(record), z(record), intensity(record)};
    record += cloud.point_step;
  }
  return points;
}

PcdHeader read_pcd_header(const std::filesystem::path& file) {
  return check_pcd(read_file(file), file);
}

bool pcd_has_labels(const std::filesystem::path& file) { return read_pcd_header(file).has_labels; }

std::vector<std::uint32_t> read_pcd_labels(const std::filesystem::path& file) {
  std::vector<std::uint32_t> labels(pcd_point_count(file));
  if (labels.empty()) return labels;
  pcl::PCLPointCloud2 cloud;
  read_cloud(file, labels.size(), cloud);
  const FieldReader label = field_reader(cloud, "label", true, file);
  const std::uint8_t* record = cloud.data.data();
  for (std::size_t i = 0; i < labels.size(); ++i, record += cloud.point_step) {
    const double value = label.value(record);
    if (!(value >= 0.0 && value <= 4294967295.0 && value == std::floor(value))) {
      throw DataError(file, "point " + std::to_string(i) + " has a label that is no id",
                      "whole numbers");
    }
    labels[i] = static_cast<std::uint32_t>(value);
  }
  return labels;
}

std::size_t pcd_point_count(const std::filesystem::path& file) {
  return read_pcd_header(file).points;
}

}  // namespace mosbench
