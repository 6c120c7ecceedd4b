#include "datasets/files/pcd_file.hpp"

#include <dlfcn.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/pcd_header.hpp"
#include "datasets/files/pcl_module.hpp"

namespace mosbench {
namespace {

template <typename Stored>
double load(const std::uint8_t* bytes) {
  Stored value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

using LoadField = double (*)(const std::uint8_t*);

/// By data type, from 1 on.
constexpr std::array<LoadField, 8> kLoaders = {
    load<std::int8_t>,  load<std::uint8_t>,  load<std::int16_t>, load<std::uint16_t>,
    load<std::int32_t>, load<std::uint32_t>, load<float>,        load<double>};

/// Nothing for a type that is none of them.
LoadField loader_of(std::uint8_t datatype) {
  return datatype >= 1 && datatype <= kLoaders.size() ? kLoaders[datatype - 1u] : nullptr;
}

double zero(const std::uint8_t*) { return 0.0; }

struct FieldReader {
  LoadField load = zero;
  std::size_t offset_bytes = 0;
  double value(const std::uint8_t* point) const { return load(point + offset_bytes); }
  float operator()(const std::uint8_t* point) const { return static_cast<float>(value(point)); }
};

FieldReader field_reader(const RawCloud& cloud, std::string_view name, bool required,
                         const std::filesystem::path& file) {
  for (const RawCloud::Field& field : cloud.fields) {
    if (field.name != name) continue;
    const LoadField load_field = loader_of(field.datatype);
    if (load_field == nullptr || field.count != 1) break;
    return {load_field, field.offset_bytes};
  }
  if (!required) return {};
  throw DataError(file, "has no numeric field " + std::string(name), "fields x y z [intensity]");
}

struct PclModule {
  ReadPcdCloud* reader = nullptr;
  std::string trouble = "it is in none of its places";
};

PclModule open_pcl_module() {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  PclModule opened;
  for (const std::filesystem::path& folder : {program.parent_path() / MOSBENCH_MODULES_FROM_PROGRAM,
                                              std::filesystem::path(MOSBENCH_MODULES_INSTALLED),
                                              std::filesystem::path(MOSBENCH_MODULES_BUILT)}) {
    const auto file = folder / kPclModule;
    if (!file.is_absolute() || !std::filesystem::exists(file, ignored)) continue;
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* function = module == nullptr ? nullptr : dlsym(module, kPclModuleFunction);
    opened.reader = reinterpret_cast<ReadPcdCloud*>(function);
    if (opened.reader != nullptr) return opened;
    opened.trouble = dlerror();
  }
  return opened;
}

/// PCL and all it stands on cost every start of the program 22 MB and 30 ms, so they are loaded
/// when the first .pcd file is read.
ReadPcdCloud* pcl_reader(const std::filesystem::path& file) {
  static const PclModule module = open_pcl_module();
  if (module.reader != nullptr) return module.reader;
  throw DataError(file,
                  std::string("cannot be read without ") + kPclModule + " (" + module.trouble + ")",
                  "the module where mosbench was built or installed, and Debian's PCL libraries");
}

/// The checked file as PCL reads it, with `count` points.
RawCloud read_cloud(const std::filesystem::path& file, std::size_t count) {
  RawCloud cloud;
  std::string why = pcl_reader(file)(file.c_str(), cloud);
  if (why.empty()) {
    if (cloud.point_step_bytes > 0 && cloud.bytes.size() / cloud.point_step_bytes >= count) {
      return cloud;
    }
    why = "less than the points of its header";
  }
  throw DataError(file, "cannot be read as a point cloud (" + why + ")",
                  "a PCD file, version 0.7, with fields x y z [intensity]");
}

}  // namespace

bool reads_pcd() { return true; }

std::vector<Point> read_pcd(const std::filesystem::path& file) {
  const std::size_t count = pcd_point_count(file);
  if (count == 0) return {};
  const RawCloud cloud = read_cloud(file, count);
  const FieldReader x = field_reader(cloud, "x", true, file);
  const FieldReader y = field_reader(cloud, "y", true, file);
  const FieldReader z = field_reader(cloud, "z", true, file);
  const FieldReader intensity = field_reader(cloud, "intensity", false, file);

  std::vector<Point> points(count);
  const std::uint8_t* record = cloud.bytes.data();
  for (Point& point : points) {
    point = {x(record), y(record), z(record), intensity(record)};
    record += cloud.point_step_bytes;
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
  const RawCloud cloud = read_cloud(file, labels.size());
  const FieldReader label = field_reader(cloud, "label", true, file);
  const std::uint8_t* record = cloud.bytes.data();
  for (std::size_t i = 0; i < labels.size(); ++i, record += cloud.point_step_bytes) {
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
