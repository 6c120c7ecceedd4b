#include "datasets/formats/pcl_module.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <exception>
#include <sstream>
#include <utility>

namespace mosbench {
namespace {

static_assert(pcl::PCLPointField::INT8 == 1 && pcl::PCLPointField::FLOAT64 == 8,
              "PCL numbers its types as CloudField does");

std::string unpack(std::string_view bytes, std::size_t body_offset_bytes, PclCloud& cloud) {
  constexpr int kAscii = 0, kCompressed = 2;
  // PCL would report every bad file on the console as well.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCDReader reader;
  pcl::PCLPointCloud2 read;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, storage = 0;
  unsigned int offset_bytes = 0;
  std::istringstream header(std::string(bytes.substr(0, body_offset_bytes)));
  if (reader.readHeader(header, read, origin, orientation, version, storage, offset_bytes) < 0) {
    return "PCL does not read its header";
  }
  if (read.fields.empty()) return "PCL finds no fields in its header";
  int result = 0;
  if (storage == kAscii) {
    std::istringstream body(std::string(bytes.substr(body_offset_bytes)));
    result = reader.readBodyASCII(body, read, version);
  } else {
    result =
        reader.readBodyBinary(reinterpret_cast<const unsigned char*>(bytes.data()), read, version,
                              storage == kCompressed, static_cast<unsigned int>(body_offset_bytes));
  }
  if (result < 0) return "PCL does not read its points";
  for (const pcl::PCLPointField& field : read.fields) {
    cloud.head.fields.push_back({field.name, field.offset, field.datatype, field.count});
  }
  cloud.head.point_step_bytes = read.point_step;
  cloud.records = std::move(read.data);
  return "";
}

}  // namespace
}  // namespace mosbench

// dlsym finds the C name; both sides are of one build, so C++ types may pass.
extern "C" __attribute__((visibility("default"))) std::string mosbench_unpack_pcd(
    std::string_view bytes, std::size_t body_offset_bytes, mosbench::PclCloud& cloud) {
  try {
    return mosbench::unpack(bytes, body_offset_bytes, cloud);
  } catch (const std::exception& error) {
    return error.what();
  }
}
